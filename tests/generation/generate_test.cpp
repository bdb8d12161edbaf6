// The bytes of a data set depend on scene and seed only: not on batch size, slices, interruptions or threads.
#include "taxelsim/generate.h"

#include <atomic>
#include <chrono>
#include <thread>

#include "episodes/example_scene.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

const Device& device() {
  static const Device opened = Device::open();
  return opened;
}

using testing::Files;

Files filesOf(const std::filesystem::path& directory) {
  return testing::filesOf(directory, {".h5", ".yaml", ".sha256"});
}

void expectSame(const Files& expected, const Files& actual, const std::string& what) {
  ASSERT_EQ(expected.size(), actual.size()) << what;
  for (const auto& [name, bytes] : expected) {
    ASSERT_TRUE(actual.contains(name)) << what << ": " << name;
    EXPECT_TRUE(actual.at(name) == bytes) << what << ": " << name << " differs";
  }
}

GenerateResult generateWith(const Scene& scene, const std::filesystem::path& directory, int batch_size, int num_slices) {
  return generate(device(), scene, directory, {.batch_size = batch_size, .num_slices = num_slices, .on_progress = {}, .stop = nullptr});
}

void expectIndependentOfBatch(const Scene& scene) {
  const TestDirectory directory;
  const GenerateResult result = generateWith(scene, directory.path() / "reference", 1, 1);
  EXPECT_TRUE(result.complete);
  EXPECT_EQ(result.progress.episodes_done, scene.num_episodes);
  EXPECT_EQ(result.progress.frames_done, scene.num_episodes * static_cast<std::uint64_t>(scene.num_steps));
  const Files reference = filesOf(directory.path() / "reference");
  EXPECT_EQ(reference.size(), 2 * 5u + 3u);  // shards and the virtual view with their checksums, manifest
  for (const auto& [batch_size, num_slices] : {std::pair{1, 3}, {7, 1}, {7, 2}, {7, 3}, {256, 1}, {256, 2}, {256, 3}}) {
    const std::string name = std::to_string(batch_size) + "_" + std::to_string(num_slices);
    EXPECT_TRUE(generateWith(scene, directory.path() / name, batch_size, num_slices).complete);
    expectSame(reference, filesOf(directory.path() / name), name);
  }
}

TEST(Generate, ServoDoesNotDependOnBatchOrSlices) {
  expectIndependentOfBatch(exampleScene());
}

TEST(Generate, ContactsDoNotDependOnBatchOrSlices) {
  expectIndependentOfBatch(exampleContacts());
}

TEST(Generate, InterruptedAndResumedRunGivesTheSameBytes) {
  Scene scene = exampleScene();
  scene.num_episodes = 400;
  const TestDirectory directory;
  const std::filesystem::path whole = directory.path() / "whole", parts = directory.path() / "parts";
  EXPECT_TRUE(generateWith(scene, whole, 64, 2).complete);

  std::atomic<bool> stop = false;
  std::thread watcher([&] {
    while (!std::filesystem::exists(parts / "shard-000000.h5")) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    stop = true;
  });
  const GenerateResult first = generate(device(), scene, parts, {.batch_size = 3, .num_slices = 2, .on_progress = {}, .stop = &stop});
  watcher.join();
  EXPECT_FALSE(first.complete);
  EXPECT_GE(first.progress.episodes_done, scene.episodes_per_shard);
  EXPECT_LT(first.progress.episodes_done, scene.num_episodes);
  EXPECT_EQ(first.progress.episodes_resumed, 0u);
  EXPECT_FALSE(std::filesystem::exists(parts / "dataset.h5"));

  const GenerateResult second = generateWith(scene, parts, 64, 3);
  EXPECT_TRUE(second.complete);
  EXPECT_EQ(second.progress.episodes_resumed, first.progress.episodes_done);
  expectSame(filesOf(whole), filesOf(parts), "resumed");

  const GenerateResult third = generateWith(scene, parts, 64, 2);
  EXPECT_TRUE(third.complete);
  EXPECT_EQ(third.progress.frames_done, 0u);
  EXPECT_EQ(third.progress.episodes_resumed, scene.num_episodes);
  expectSame(filesOf(whole), filesOf(parts), "nothing to do");
}

TEST(Generate, RegeneratesMissingShards) {
  const Scene scene = exampleScene();
  const TestDirectory directory;
  generateWith(scene, directory.path(), 4, 2);
  const Files before = filesOf(directory.path());
  for (const char* name : {"shard-000001.h5", "shard-000004.h5"}) std::filesystem::remove(directory.path() / name);
  const GenerateResult result = generateWith(scene, directory.path(), 256, 1);
  EXPECT_TRUE(result.complete);
  EXPECT_EQ(result.progress.frames_done, 8u * 7u);  // shard 4 holds episodes 20 to 22
  expectSame(before, filesOf(directory.path()), "regenerated");
}

TEST(Generate, ReportsTimesOfDeviceAndWriter) {
  const TestDirectory directory;
  const auto [progress, times, complete, verified, num_load_misses, load_misses, contact_misses] =
      generate(device(), exampleScene(), directory.path(), {.batch_size = 8, .num_slices = 2, .device_clock = true});
  EXPECT_GT(times.device_busy, 0);
  EXPECT_GT(times.device_wait, 0);
  EXPECT_GT(times.writing_last, 0);
  EXPECT_GE(times.writer_wait, 0);
  EXPECT_LT(times.device_wait + times.writer_wait + times.writing_last, progress.seconds) << "disjoint parts of the scheduler's time";
}

TEST(Generate, RunStoppedAtOnceCanBeResumed) {
  const TestDirectory directory;
  const std::atomic<bool> stop = true;
  const GenerateResult result = generate(device(), exampleScene(), directory.path(), {.on_progress = {}, .stop = &stop});
  EXPECT_FALSE(result.complete);
  EXPECT_EQ(result.progress.episodes_done, 0u);
  EXPECT_TRUE(generateWith(exampleScene(), directory.path(), 16, 2).complete);
}

TEST(Generate, ReportsProgressUpToTheEnd) {
  const TestDirectory directory;
  Progress last;
  int num_calls = 0;
  const auto listen = [&](const Progress& progress) {
    EXPECT_GE(progress.episodes_done, last.episodes_done);
    EXPECT_GE(progress.seconds, last.seconds);
    last = progress;
    ++num_calls;
  };
  generate(device(), exampleScene(), directory.path(), {.batch_size = 2, .on_progress = listen, .stop = nullptr});
  EXPECT_GE(num_calls, 1);
  EXPECT_EQ(last.episodes_done, 23u);
  EXPECT_EQ(last.num_episodes, 23u);
  EXPECT_EQ(last.frames_done, 23u * 7u);
}

TEST(Generate, RejectsCountsOutOfRange) {
  const TestDirectory directory;
  EXPECT_THROW(generateWith(exampleScene(), directory.path(), 0, 2), Error);
  EXPECT_THROW(generateWith(exampleScene(), directory.path(), 16, 0), Error);
  Scene scene = exampleScene();
  scene.num_episodes = 0;
  EXPECT_THROW(generateWith(scene, directory.path(), 16, 2), Error);
  scene = exampleScene();
  scene.objects[1].object = Object(Mesh{{{0, 0, 0}}, {{0, 1, 2}}});
  EXPECT_THROW(generateWith(scene, directory.path(), 16, 2), Error);
  EXPECT_FALSE(std::filesystem::exists(directory.path()));
}

TEST(Generate, RejectsABatchThatExceedsDeviceMemory) {
  const TestDirectory directory;
  Scene scene = exampleScene();
  scene.record = {};
  scene.num_steps = 1;
  scene.num_episodes = 1 << 30;
  scene.episodes_per_shard = 1 << 16;
  try {
    generateWith(scene, directory.path(), 1 << 30, 2);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput) << error.what();
  }
}

TEST(Generate, RejectsShardsThatExceedHostMemory) {
  const TestDirectory directory;
  Scene scene = exampleScene();
  scene.num_steps = 1'000'000;
  scene.num_episodes = scene.episodes_per_shard = 1'000'000;
  EXPECT_THAT(support::inputError([&] { generateWith(scene, directory.path(), 16, 2); }), ::testing::HasSubstr("episodes_per_shard"));
  EXPECT_FALSE(std::filesystem::exists(directory.path()));
}

TEST(Generate, MovingObjectsDoNotDependOnBatchOrSlices) {
  Scene scene = exampleScene();
  scene.objects[0].motion = HandHeld{};
  scene.objects[1].motion = Sinusoid{.axis = {0, 0, 1}, .amplitude = 1e-4, .frequency = 5};
  expectIndependentOfBatch(scene);
}

TEST(Generate, RobotsDoNotDependOnBatchOrSlices) {
  Scene scene = exampleScene();
  scene.record.emplace_back("robot");
  PanTilt platform;
  platform.drive.delay = 3;
  scene.robot = panTilt(platform);
  expectIndependentOfBatch(scene);
}

// With two sensors: arrays on the same link, kSensorSpacing apart along y.
constexpr double kSensorSpacing = 0.04;  // m

Robot robotWith(int num_sensors) {
  PanTilt platform;
  if (num_sensors > 1) platform.sensors.push_back({"tilt", {{0, kSensorSpacing, 0.03}, {1, 0, 0, 0}}});
  return panTilt(platform);
}

TEST(Generate, SeveralSensorsOfARobotDoNotDependOnBatchOrSlices) {
  Scene scene = exampleScene();
  scene.robot = robotWith(2);
  expectIndependentOfBatch(scene);
}

TEST(Generate, FirstSensorIsIndependentOfOtherSensors) {
  Scene scene = exampleScene();
  scene.sensor.readout.noise = 0;
  scene.randomization.gain_spread = scene.randomization.noise = {0, 0};
  scene.randomization.load.reset();
  scene.randomization.depth = Range{1e-4, 5e-4};
  scene.record = {"tactile_image", "features", "poses"};
  const TestDirectory directory;
  std::vector<std::map<std::string, std::vector<double>>> columns(2);
  for (const int num_sensors : {1, 2}) {
    scene.robot = robotWith(num_sensors);
    const std::filesystem::path path = directory.path() / std::to_string(num_sensors);
    ASSERT_TRUE(generateWith(scene, path, 7, 2).complete);
    const DatasetReader reader(path);
    for (const char* name : {"data/tactile_image", "data/total_force", "data/pose", "data/sensor_pose"}) {
      const std::vector<double> values = reader.readAsDouble(name, 0, reader.numFrames());
      const std::size_t row = values.size() / reader.numFrames(), sensor_row = row / static_cast<std::size_t>(num_sensors);
      for (std::size_t at = 0; at < values.size(); at += row) {
        std::vector<double>& first = columns[static_cast<std::size_t>(num_sensors - 1)][name];
        first.insert(first.end(), values.begin() + static_cast<std::ptrdiff_t>(at),
                     values.begin() + static_cast<std::ptrdiff_t>(at + sensor_row));
      }
    }
  }
  EXPECT_EQ(columns[0], columns[1]);
}

// A plate over both sensors: when sensor 0 carries the load, sensor 1 reads the same force.
TEST(Generate, AllSensorsSeeTheObjectAtItsInitialContact) {
  Scene scene = exampleScene();
  scene.robot = robotWith(2);
  scene.sensor.readout.noise = 0;
  scene.randomization = {};
  scene.randomization.load = Range{1, 4};
  scene.objects.resize(1);
  scene.objects[0] = {.object = Object("plate", HalfSpace{})};
  scene.record = {"ground_truth", "poses"};
  const TestDirectory directory;
  ASSERT_TRUE(generateWith(scene, directory.path(), 7, 2).complete);
  const DatasetReader reader(directory.path());
  const std::vector<double> force = reader.readAsDouble("data/ground_truth/total_force", 0, reader.numFrames());
  const std::vector<double> sensor_pose = reader.readAsDouble("data/sensor_pose", 0, reader.numFrames());
  const std::vector<double> load = reader.readAsDouble("meta/load", 0, scene.num_episodes);
  const auto num_steps = static_cast<std::size_t>(scene.num_steps);
  ASSERT_EQ(force.size(), 2 * num_steps * scene.num_episodes);
  // Relative: tolerance of the load search, 1e-3, and rounding of heights to float32.
  constexpr double kLoadTolerance = 2e-3;
  for (std::size_t e = 0; e < scene.num_episodes; ++e) {
    const std::size_t row = e * num_steps;
    for (const std::size_t s : {std::size_t{0}, std::size_t{1}})
      EXPECT_NEAR(force[2 * row + s], load[e], kLoadTolerance * load[e]) << e << " " << s;
    // At frame 0 the axes of W are those of sensor 0.
    EXPECT_NEAR(sensor_pose[7 * (2 * row + 1) + 1] - sensor_pose[7 * (2 * row) + 1], kSensorSpacing, 1e-12);
  }
}

TEST(Generate, RejectsInvalidMotion) {
  const TestDirectory directory;
  Scene scene = exampleScene();
  scene.objects[0].motion = Sinusoid{.frequency = 0};
  EXPECT_THROW(generateWith(scene, directory.path(), 16, 2), Error);
  EXPECT_FALSE(std::filesystem::exists(directory.path()));
}

// A ball starts beside the array, touches with 0 N, is out of reach of a load, which LoadMisses counts, or touches.
TEST(Generate, CountsEpisodesWithoutContact) {
  Scene scene = exampleScene();
  scene.objects.erase(scene.objects.begin());
  scene.randomization.yaw = scene.randomization.tilt = {0, 0};
  const auto missesOf = [&](std::optional<Range> load, std::optional<Range> depth, double x = 0) {
    Scene changed = scene;
    changed.randomization.load = load;
    changed.randomization.depth = depth;
    changed.randomization.x = {x, x};
    const TestDirectory directory;
    return generateWith(changed, directory.path(), 7, 2).contact_misses.at(0);
  };
  const ContactMisses beside = missesOf({}, Range{5e-4, 5e-4}, 0.3), weightless = missesOf(Range{0, 0}, {});
  for (const ContactMisses& misses : {beside, weightless}) {
    EXPECT_EQ(misses.num_episodes, 23u);
    EXPECT_EQ(misses.num_misses, 23u);
  }
  EXPECT_NEAR(beside.nearest, 0.3 - 0.01 - 0.0102, 1e-12) << "less the radius, and half of the array";
  EXPECT_EQ(missesOf(Range{1e5, 1e5}, {}).num_misses, 0u);
  EXPECT_EQ(missesOf({}, Range{5e-4, 5e-4}).num_misses, 0u);
}

}  // namespace
}  // namespace taxelsim
