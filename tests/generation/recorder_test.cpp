#include "generation/recorder.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <numeric>

#include "episodes/example_scene.h"

namespace taxelsim {
namespace {

constexpr std::size_t kNumInstances = 3, kNumTaxels = 84;

// Every array of a frame, filled with numbers that are all different.
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
    std::iota(values.begin(), values.end(), -1);
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

  // The sensor, its patch and two regions.
  void fill(ContactFeatureView& contact) {
    constexpr std::size_t kRows = 4;
    contact.num_rows = kRows;
    contact.num_patches = 1;
    for (std::span<const float>* values :
         {&contact.total_force, &contact.peak_force, &contact.edge_angle, &contact.edge_confidence, &contact.contact_area,
          &contact.windowed_edge_angle, &contact.windowed_edge_confidence, &contact.tilt_confidence}) {
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
    arrays.reserve(64);
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

template <typename T, typename V>
std::vector<T> part(const V& values, std::size_t instance, std::size_t width) {
  return {values.begin() + static_cast<std::ptrdiff_t>(instance * width),
          values.begin() + static_cast<std::ptrdiff_t>((instance + 1) * width)};
}

TEST(Recorder, PutsEveryValueInItsPlace) {
  Scene scene = exampleScene();
  scene.robot = panTilt({});
  scene.record.emplace_back("robot");
  const ColumnPlan plan = planColumns(scene);
  Manifest manifest;
  manifest.num_episodes = 4;
  manifest.episodes_per_shard = 2;
  std::map<std::string, std::size_t> index;
  for (const FrameColumn& entry : plan.frame) {
    index[entry.column.name] = manifest.columns.size();
    manifest.columns.push_back(entry.column);
  }
  for (const EpisodeColumn& entry : plan.episode) {
    index[entry.column.name] = manifest.columns.size();
    manifest.columns.push_back(entry.column);
  }
  constexpr int kNumFrames = 3;
  ShardQueue queue(manifest, {false, false}, kNumFrames);
  // Instance 0 plays episode 2 (second shard, first row) at its frame 1, instance 1 idles, instance 2 plays episode 1 at frame 2.
  queue.next();
  const EpisodePlace second = *queue.next();
  const EpisodePlace third = *queue.next();
  for (const EpisodePlace& place : {second, third}) {
    for (std::vector<std::byte>& column : place.buffer->data.columns) std::fill(column.begin(), column.end(), std::byte{0xee});
  }

  const ExampleFrame frame;
  const std::vector<FramePlace> places{{third.buffer->columns.data(), 1}, {}, {second.buffer->columns.data(), kNumFrames + 2}};
  const std::vector<double> times{0.1, 0, 0.2};
  const std::vector<Pose> X_SO{{{1, 2, 3}, {0.5, 0.5, 0.5, 0.5}}, {}, {{4, 5, 6}, {1, 0, 0, 0}}};
  const std::vector<Twist> twists{{{1, 2, 3}, {4, 5, 6}}, {}, {{-1, -2, -3}, {-4, -5, -6}}};
  const Recorder recorder(plan);
  Robots robots(scene.robot, 3);
  robots.command(twists, 0.01);
  recorder.recordFrames(frame.view,
                        {.active = {},
                         .times = times,
                         .num_sensors = 1,
                         .X_SO = X_SO,
                         .X_WO = {},
                         .actions = twists,
                         .controller_actions = {},
                         .robots = &robots},
                        places);

  for (const std::size_t instance : {std::size_t{0}, std::size_t{2}}) {
    const ShardBuffer& buffer = instance == 0 ? *third.buffer : *second.buffer;
    const std::uint64_t row = places[instance].row;
    for (std::size_t c = 0; c < plan.frame.size(); ++c) {
      const FrameColumn& entry = plan.frame[c];
      if (entry.source != FrameColumn::Source::kFeature) continue;
      const std::size_t width = rowBytes(entry.column) / sizeof(float);
      std::visit(
          [&](const auto& values) {
            std::vector<float> expected;
            for (const auto value : values.subspan(instance * width, width)) expected.push_back(static_cast<float>(value));
            EXPECT_EQ(rowOf<float>(buffer, c, row, width), expected) << entry.column.name;
          },
          entry.values(frame.view));
    }
    EXPECT_EQ(rowOf<std::uint16_t>(buffer, index.at("data/tactile_image"), row, kNumTaxels),
              part<std::uint16_t>(frame.counts, instance, kNumTaxels));
    EXPECT_EQ(rowOf<double>(buffer, index.at("data/time"), row, 1)[0], times[instance]);
  }
  EXPECT_EQ(rowOf<double>(*third.buffer, index.at("data/pose"), 1, 7), (std::vector<double>{1, 2, 3, 0.5, 0.5, 0.5, 0.5}));
  const auto& [p, q] = robots.X_WS()[0];
  EXPECT_EQ(rowOf<double>(*third.buffer, index.at("data/sensor_pose"), 1, 7),
            (std::vector<double>{p[0], p[1], p[2], q[0], q[1], q[2], q[3]}));
  EXPECT_NE(robots.jointPositions()[0], robots.jointPositions()[4]);
  EXPECT_EQ(rowOf<double>(*third.buffer, index.at("data/robot/joint_position"), 1, 2), part<double>(robots.jointPositions(), 0, 2));
  EXPECT_EQ(rowOf<double>(*second.buffer, index.at("data/robot/joint_velocity"), kNumFrames + 2, 2),
            part<double>(robots.jointVelocities(), 2, 2));
  EXPECT_EQ(rowOf<std::int32_t>(*third.buffer, index.at("data/robot/status"), 1, 1)[0], robots.status()[0]);
  EXPECT_EQ(rowOf<float>(*third.buffer, index.at("data/action"), 1, 6), (std::vector<float>{1, 2, 3, 4, 5, 6}));
  // Features by name, so that the table itself is checked and not only what it says.
  EXPECT_EQ(rowOf<float>(*third.buffer, index.at("data/edge_angle"), 1, 1)[0], frame.view.edge_angle[0]);
  EXPECT_EQ(rowOf<float>(*third.buffer, index.at("data/ground_truth/edge_angle"), 1, 1)[0], frame.view.ground_truth.edge_angle[0]);
  EXPECT_EQ(rowOf<float>(*third.buffer, index.at("data/contact_area"), 1, 1)[0], frame.view.contact_area[0]);
  EXPECT_EQ(rowOf<float>(*third.buffer, index.at("data/saturated"), 1, 1)[0], frame.view.saturated[0]);

  // Other rows are untouched.
  EXPECT_EQ(rowOf<std::uint8_t>(*third.buffer, index.at("data/total_force"), 0, 4), (std::vector<std::uint8_t>(4, 0xee)));
  EXPECT_EQ(rowOf<std::uint8_t>(*third.buffer, index.at("data/total_force"), 2, 4), (std::vector<std::uint8_t>(4, 0xee)));

  recorder.recordEpisode(
      {.episode = 1, .object = 2, .load = 3, .load_driven = 1, .depth = 5, .load_reached = 1, .gain = 7, .gain_spread = 8, .noise = 9},
      second);
  EXPECT_EQ(rowOf<std::uint64_t>(*second.buffer, index.at("meta/episode"), 1, 1)[0], 1u);
  EXPECT_EQ(rowOf<std::int32_t>(*second.buffer, index.at("meta/object"), 1, 1)[0], 2);
  EXPECT_EQ(rowOf<float>(*second.buffer, index.at("meta/load"), 1, 1)[0], 3);
  EXPECT_EQ(rowOf<std::int32_t>(*second.buffer, index.at("meta/load_driven"), 1, 1)[0], 1);
  EXPECT_EQ(rowOf<float>(*second.buffer, index.at("meta/depth"), 1, 1)[0], 5);
  EXPECT_EQ(rowOf<std::int32_t>(*second.buffer, index.at("meta/load_reached"), 1, 1)[0], 1);
  EXPECT_EQ(rowOf<float>(*second.buffer, index.at("meta/gain"), 1, 1)[0], 7);
  EXPECT_EQ(rowOf<float>(*second.buffer, index.at("meta/gain_spread"), 1, 1)[0], 8);
  EXPECT_EQ(rowOf<float>(*second.buffer, index.at("meta/noise"), 1, 1)[0], 9);
}

}  // namespace
}  // namespace taxelsim
