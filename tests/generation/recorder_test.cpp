// Every value of a frame and of an episode must land in its column and row. Columns are found by name, so that the column table is tested,
// too.
#include "generation/recorder.h"

#include "control/robots.h"
#include "episodes/example_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr std::size_t kNumInstances = 3, kNumTaxels = 84;

// A frame whose arrays hold distinct numbers.
struct ExampleFrame {
  std::vector<std::vector<float>> arrays;
  std::vector<std::vector<std::int32_t>> integers;
  std::vector<ContactType> types;
  std::vector<std::uint32_t> counts;
  FrameView view;

  std::span<const float> next(std::size_t width) {
    std::vector<float> values(kNumInstances * width);
    std::iota(values.begin(), values.end(), static_cast<float>(1000 * arrays.size()));
    arrays.push_back(std::move(values));
    return arrays.back();
  }

  std::span<const std::int32_t> nextIntegers(std::size_t width) {
    std::vector<std::int32_t> values(kNumInstances * width);
    std::iota(values.begin(), values.end(), integers.size() % 2 == 0 ? -1 : 3);  // patches, counts
    integers.push_back(std::move(values));
    return integers.back();
  }

  void fill(FeatureView& features) {
    features.total_force = next(1);
    features.peak_force = next(1);
    features.center_of_pressure = next(3);
    features.second_moments = next(3);
    features.eigenvalues = next(2);
    features.edge_angle = next(1);
    features.edge_confidence = next(1);
    features.contact_area = next(1);
  }

  // Rows: the sensor, its patch and two regions.
  void fill(ContactFeatureView& contact) {
    constexpr std::size_t kRows = 4;
    contact.num_rows = kRows;
    contact.num_patches = 1;
    for (std::span<const float>* values : {&contact.total_force, &contact.peak_force, &contact.edge_angle, &contact.edge_confidence,
                                           &contact.contact_area, &contact.windowed_edge_angle, &contact.windowed_edge_confidence,
                                           &contact.ridge_edge_angle, &contact.ridge_edge_confidence, &contact.tilt_confidence}) {
      *values = next(kRows);
    }
    for (std::span<const float>* values : {&contact.center_of_pressure, &contact.second_moments}) *values = next(3 * kRows);
    for (std::span<const float>* values : {&contact.eigenvalues, &contact.tilt}) *values = next(2 * kRows);
    types.assign(kNumInstances * kRows, ContactType::kEdge);
    for (std::size_t i = 0; i < types.size(); i += 2) types[i] = ContactType::kPoint;
    contact.contact_type = types;
    contact.patch = nextIntegers(kRows);
    contact.num_regions = nextIntegers(1);
  }

  ExampleFrame() : counts(kNumInstances * kNumTaxels) {
    arrays.reserve(96);
    fill(view);
    fill(view.ground_truth);
    view.saturated = next(1);
    view.ground_truth.tactile_normal_force = next(kNumTaxels);
    view.ground_truth.tactile_shear_force = next(2 * kNumTaxels);
    view.ground_truth.penetration_depth = next(kNumTaxels);
    view.ground_truth.contact_wrench = next(6);
    view.ground_truth.over_penetration = next(1);
    fill(view.contact);
    fill(view.ground_truth.contact);
    std::iota(counts.begin(), counts.end(), 65535u - static_cast<std::uint32_t>(counts.size()));
    view.tactile_image = counts;
  }
};

template <typename T>
std::vector<T> rowOf(const ShardBuffer& buffer, std::size_t column, std::uint64_t row, std::size_t width) {
  std::vector<T> values(width);
  std::memcpy(values.data(), buffer.columns[column] + row * width * sizeof(T), width * sizeof(T));
  return values;
}

std::vector<double> numbersOf(const Column& column, const ShardBuffer& buffer, std::size_t index, std::uint64_t row, std::size_t width) {
  const auto read = [&]<typename T>(T) {
    const std::vector<T> values = rowOf<T>(buffer, index, row, width);
    return std::vector<double>(values.begin(), values.end());
  };
  switch (column.type) {
    case ScalarType::kUint8:
      return read(std::uint8_t{});
    case ScalarType::kUint16:
      return read(std::uint16_t{});
    case ScalarType::kInt16:
      return read(std::int16_t{});
    default:
      return read(float{});
  }
}

template <typename T, typename V>
std::vector<T> part(const V& values, std::size_t instance, std::size_t width) {
  return {values.begin() + static_cast<std::ptrdiff_t>(instance * width),
          values.begin() + static_cast<std::ptrdiff_t>((instance + 1) * width)};
}

// Two instances record into two shards: instance 0 runs episode 2 (second shard, episode row 0) and is at its frame 1, instance 2 runs
// episode 1 (first shard, episode row 1) and is at its frame 2. Instance 1 is idle.
class RecorderTest : public ::testing::Test {
 protected:
  static constexpr int kNumFrames = 3;
  static constexpr std::byte kUnwritten{0xee};

  RecorderTest() {
    scene_.robot = panTilt({});
    scene_.record.emplace_back("robot");
    scene_.objects[0].edge = Vector3{1, 0, 0};
    for (const SceneObject& object : scene_.objects) edges_.emplace_back(object);
    plan_ = planColumns(scene_);
    manifest_.num_episodes = 4;
    manifest_.episodes_per_shard = 2;
    for (const FrameColumn& entry : plan_.frame) addColumn(entry.column);
    for (const EpisodeColumn& entry : plan_.episode) addColumn(entry.column);
    queue_.emplace(manifest_, std::vector<bool>{false, false}, kNumFrames);
    queue_->next();
    episode_1_ = *queue_->next();
    episode_2_ = *queue_->next();
    for (const EpisodePlace& place : {episode_1_, episode_2_}) {
      for (std::vector<std::byte>& column : place.buffer->data.columns) std::fill(column.begin(), column.end(), kUnwritten);
    }
    places_ = {{episode_2_.buffer->columns.data(), 1, 0}, {}, {episode_1_.buffer->columns.data(), kNumFrames + 2, 1}};
  }

  void recordFrame() {
    robots_.emplace(scene_.robot, static_cast<int>(kNumInstances));
    robots_->command(twists_, 0.01);
    Recorder(plan_, edges_)
        .recordFrames(frame_.view,
                      {.active = {},
                       .times = times_,
                       .num_sensors = 1,
                       .X_SO = X_SO_,
                       .X_WO = {},
                       .actions = twists_,
                       .controller_actions = {},
                       .X_WS = robots_->X_WS(),
                       .joint_positions = robots_->jointPositions(),
                       .joint_velocities = robots_->jointVelocities(),
                       .robot_status = robots_->status(),
                       .team = &team_},
                      places_);
  }

  const ShardBuffer& bufferOf(std::size_t instance) const { return instance == 0 ? *episode_2_.buffer : *episode_1_.buffer; }

  // `width` values of the recorded frame row of an instance.
  template <typename T>
  std::vector<T> frameRow(std::size_t instance, const char* column, std::size_t width) const {
    return rowOf<T>(bufferOf(instance), index_.at(column), places_[instance].row, width);
  }

  Scene scene_ = exampleScene();
  std::vector<TrueEdge> edges_;
  ColumnPlan plan_;
  Manifest manifest_;
  std::map<std::string, std::size_t> index_;
  std::optional<ShardQueue> queue_;
  EpisodePlace episode_1_, episode_2_;
  std::vector<FramePlace> places_;
  const ExampleFrame frame_;
  const std::vector<double> times_{0.1, 0, 0.2};
  const std::vector<Pose> X_SO_{{{1, 2, 3}, {0.5, 0.5, 0.5, 0.5}}, {}, {{4, 5, 6}, {1, 0, 0, 0}}};
  const std::vector<Twist> twists_{{{1, 2, 3}, {4, 5, 6}}, {}, {{-1, -2, -3}, {-4, -5, -6}}};
  std::optional<Robots> robots_;
  ThreadTeam team_{2};  // divides the instances between the idle one and the last

 private:
  void addColumn(const Column& column) {
    index_[column.name] = manifest_.columns.size();
    manifest_.columns.push_back(column);
  }
};

TEST_F(RecorderTest, WritesOutputsOfTheSimulator) {
  recordFrame();
  for (const std::size_t instance : {std::size_t{0}, std::size_t{2}}) {
    for (std::size_t c = 0; c < plan_.frame.size(); ++c) {
      const FrameColumn& entry = plan_.frame[c];
      if (entry.source != FrameColumn::Source::kFeature) continue;
      const std::size_t width = rowBytes(entry.column) / scalarSize(entry.column);
      std::visit(
          [&](const auto& values) {
            std::vector<double> expected;
            for (const auto value : values.subspan(instance * width, width)) expected.push_back(static_cast<double>(value));
            EXPECT_EQ(numbersOf(entry.column, bufferOf(instance), c, places_[instance].row, width), expected) << entry.column.name;
          },
          entry.values(frame_.view));
    }
    EXPECT_EQ(frameRow<std::uint16_t>(instance, "data/tactile_image", kNumTaxels),
              part<std::uint16_t>(frame_.counts, instance, kNumTaxels));
    EXPECT_EQ(frameRow<double>(instance, "data/time", 1)[0], times_[instance]);
  }
}

TEST_F(RecorderTest, WritesFeaturesToTheColumnsOfTheirNames) {
  recordFrame();
  EXPECT_EQ(frameRow<float>(0, "data/edge_angle", 1)[0], frame_.view.edge_angle[0]);
  EXPECT_EQ(frameRow<float>(0, "data/ground_truth/edge_angle", 1)[0], frame_.view.ground_truth.edge_angle[0]);
  EXPECT_EQ(frameRow<float>(0, "data/contact_area", 1)[0], frame_.view.contact_area[0]);
  EXPECT_EQ(frameRow<float>(0, "data/saturated", 1)[0], frame_.view.saturated[0]);
}

TEST_F(RecorderTest, WritesPosesActionsAndRobotState) {
  recordFrame();
  EXPECT_EQ(frameRow<double>(0, "data/pose", 7), (std::vector<double>{1, 2, 3, 0.5, 0.5, 0.5, 0.5}));
  const auto& [p, q] = robots_->X_WS()[0];
  EXPECT_EQ(frameRow<double>(0, "data/sensor_pose", 7), (std::vector<double>{p[0], p[1], p[2], q[0], q[1], q[2], q[3]}));
  EXPECT_NE(robots_->jointPositions()[0], robots_->jointPositions()[4]);
  EXPECT_EQ(frameRow<double>(0, "data/robot/joint_position", 2), part<double>(robots_->jointPositions(), 0, 2));
  EXPECT_EQ(frameRow<double>(2, "data/robot/joint_velocity", 2), part<double>(robots_->jointVelocities(), 2, 2));
  EXPECT_EQ(frameRow<std::uint8_t>(0, "data/robot/status", 1)[0], robots_->status()[0]);
  EXPECT_EQ(frameRow<float>(0, "data/action", 6), (std::vector<float>{1, 2, 3, 4, 5, 6}));
}

TEST_F(RecorderTest, LeavesOtherRowsUnwritten) {
  recordFrame();
  const std::size_t column = index_.at("data/total_force");
  for (const std::uint64_t row : {std::uint64_t{0}, std::uint64_t{2}}) {
    EXPECT_EQ(rowOf<std::byte>(*episode_2_.buffer, column, row, sizeof(float)), std::vector<std::byte>(sizeof(float), kUnwritten)) << row;
  }
}

TEST_F(RecorderTest, WritesTheExactEdgeOfTheObject) {
  recordFrame();
  // Instance 0 has object 0, whose edge is x of O. R_SO turns x to y.
  EXPECT_EQ(frameRow<float>(0, "data/ground_truth/exact_edge_angle", 1)[0], static_cast<float>(std::numbers::pi / 2));
  EXPECT_EQ(frameRow<std::uint8_t>(0, "data/ground_truth/exact_edge_known", 1)[0], 1);
  // Instance 2 has object 1, without an edge.
  EXPECT_EQ(frameRow<float>(2, "data/ground_truth/exact_edge_angle", 1)[0], 0);
  EXPECT_EQ(frameRow<std::uint8_t>(2, "data/ground_truth/exact_edge_known", 1)[0], 0);
}

TEST_F(RecorderTest, WritesValuesOfAnEpisode) {
  scene_.task = Task{};
  plan_.episode = planColumns(scene_).episode;
  for (std::size_t c = 0; c < plan_.episode.size(); ++c) index_[plan_.episode[c].column.name] = plan_.frame.size() + c;
  std::vector<std::byte> success(2);
  episode_1_.buffer->columns.push_back(success.data());
  Recorder(plan_, edges_)
      .recordEpisode({.record = {.episode = 1,
                                 .object = 1,
                                 .load = 3,
                                 .load_driven = 1,
                                 .depth = 5,
                                 .load_reached = 1,
                                 .gain = 7,
                                 .gain_spread = 8,
                                 .noise = 9,
                                 .controller = -1},
                      .success = true},
                     episode_1_);
  const auto value = [&]<typename T>(const char* column, T) { return rowOf<T>(*episode_1_.buffer, index_.at(column), 1, 1)[0]; };
  EXPECT_EQ(value("meta/episode", std::uint64_t{}), 1u);
  EXPECT_EQ(value("meta/object", std::uint16_t{}), 1);
  EXPECT_EQ(rowOf<char>(*episode_1_.buffer, index_.at("meta/object_name"), 1, 4), (std::vector<char>{'b', 'a', 'l', 'l'}));
  EXPECT_EQ(value("meta/load", float{}), 3);
  EXPECT_EQ(value("meta/load_driven", std::uint8_t{}), 1);
  EXPECT_EQ(value("meta/depth", float{}), 5);
  EXPECT_EQ(value("meta/load_reached", std::uint8_t{}), 1);
  EXPECT_EQ(value("meta/gain", float{}), 7);
  EXPECT_EQ(value("meta/gain_spread", float{}), 8);
  EXPECT_EQ(value("meta/noise", float{}), 9);
  EXPECT_EQ(value("meta/controller", std::int16_t{}), -1);
  EXPECT_EQ(rowOf<char>(*episode_1_.buffer, index_.at("meta/controller_name"), 1, 13), std::vector<char>(13, '\0'));
  EXPECT_EQ(value("meta/success", std::uint8_t{}), 1);
}

}  // namespace
}  // namespace taxelsim
