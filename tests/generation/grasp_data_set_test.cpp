// Data sets of hands: the same bytes for any batch size and after an interruption; columns grouped by sensor.
#include <atomic>

#include "episodes/example_scene.h"
#include "support/test.h"
#include "taxelsim/error.h"
#include "taxelsim/generate.h"

namespace taxelsim {
namespace {

Scene scene() {
  Scene loaded = loadScene(std::filesystem::path(TAXELSIM_SOURCE_DIR) / "scenes/gripper_grasp.yaml", {.num_episodes = 7});
  loaded.num_steps = 60;  // the jaws touch the box after 50
  loaded.episodes_per_shard = 3;
  loaded.record = {"tactile_image", "features", "ground_truth", "contact_features", "tactile_jacobian"};
  loaded.max_regions = 2;
  return loaded;
}

const Device& device() {
  static const Device opened = Device::open();
  return opened;
}

testing::Files shardsOf(const std::filesystem::path& directory) {
  return testing::filesOf(directory, {".h5"});
}

TEST(GraspDataSet, HasTheSameBytesForAnyBatchAndAfterAStop) {
  const TestDirectory directory;
  EXPECT_TRUE(generate(device(), scene(), directory.path() / "1", {.batch_size = 1}).complete);
  const auto expected = shardsOf(directory.path() / "1");
  EXPECT_EQ(expected.size(), 4u);  // three shards and the view
  for (const int batch_size : {7, 64}) {
    const std::filesystem::path path = directory.path() / std::to_string(batch_size);
    generate(device(), scene(), path, {.batch_size = batch_size});
    EXPECT_TRUE(expected == shardsOf(path)) << batch_size;
  }
  std::atomic<bool> stop = true;
  const std::filesystem::path path = directory.path() / "stopped";
  EXPECT_FALSE(generate(device(), scene(), path, {.stop = &stop}).verified);
  EXPECT_FALSE(std::filesystem::exists(path)) << "its probe would be incomplete";
  stop = false;
  const GenerateResult first =
      generate(device(), scene(), path, {.batch_size = 3, .on_progress = [&](const Progress&) { stop = true; }, .stop = &stop});
  EXPECT_FALSE(first.complete);
  EXPECT_EQ(first.progress.episodes_done, 3u);
  const GenerateResult second = generate(device(), scene(), path, {.batch_size = 3});
  EXPECT_TRUE(second.complete);
  EXPECT_EQ(second.progress.episodes_resumed, 3u);
  EXPECT_TRUE(expected == shardsOf(path));
}

// 70 episodes of an arm that follows a human, in one shard: batches of 1, of 7 and of 64 and 6. The fingers start 1.2 s further closed, so
// that all of them touch within 45 frames.
TEST(GraspDataSet, OfAHandOnAnArmHasTheSameBytesForAnyBatch) {
  Scene scene =
      loadScene(std::filesystem::path(TAXELSIM_SOURCE_DIR) / "scenes/experiments/paper/arm_hand_given_scene.yaml", {.num_episodes = 70});
  scene.num_steps = 45;
  scene.episodes_per_shard = 70;
  for (const GraspFinger& finger : scene.grasp->fingers) {
    for (const FingerJoint& joint : finger.joints) {
      std::get<Manipulator>(scene.robot).joints[static_cast<std::size_t>(joint.joint)].initial_position += 1.2 * joint.velocity;
    }
  }
  const TestDirectory directory;
  testing::Files expected;
  for (const int batch_size : {1, 7, 64}) {
    const std::filesystem::path path = directory.path() / std::to_string(batch_size);
    EXPECT_TRUE(generate(device(), scene, path, {.batch_size = batch_size}).complete);
    if (batch_size == 1) expected = shardsOf(path);
    EXPECT_EQ(expected.size(), 2u);  // a shard and the view
    EXPECT_TRUE(expected == shardsOf(path)) << batch_size;
  }
  const DatasetReader reader(directory.path() / "64");
  for (const char* const sensor : {"palm", "first", "middle", "ring", "little", "thumb"}) {
    EXPECT_GT(reader.readAsDouble("data/" + std::string(sensor) + "/total_force", 70 * 45 - 1, 1)[0], 0) << sensor;
  }
  const std::vector<double> joints = reader.readAsDouble("data/robot/joint_position", 0, 45);
  EXPECT_NE(joints[0], joints[joints.size() - 31]);  // a1 moves
}

TEST(GraspDataSet, PartsHaveTheBytesOfTheWhole) {
  const TestDirectory directory;
  const std::filesystem::path whole = directory.path() / "whole", parts = directory.path() / "parts";
  generate(device(), scene(), whole);
  const GenerateResult last = generate(device(), scene(), parts, {.shards = ShardRange{2, 3}});
  EXPECT_TRUE(last.complete);
  EXPECT_EQ(last.progress.num_episodes, 1u);  // of 7 in shards of 3
  EXPECT_EQ(shardsOf(parts).size(), 1u);
  EXPECT_TRUE(generate(device(), scene(), parts, {.shards = ShardRange{0, 3}}).complete);
  EXPECT_TRUE(finishDataset(parts));
  EXPECT_TRUE(shardsOf(whole) == shardsOf(parts));
}

TEST(GraspDataSet, GroupsColumnsBySensor) {
  const TestDirectory directory;
  generate(device(), scene(), directory.path() / "out", {.batch_size = 4});
  const DatasetReader reader(directory.path() / "out");
  EXPECT_EQ(reader.numFrames(), 420u);
  const std::vector<double> left = reader.readAsDouble("data/left/tactile_image", 0, 420);
  EXPECT_EQ(left.size(), 420u * 24);
  EXPECT_EQ(reader.readAsDouble("data/right/tactile_image", 0, 420).size(), 420u * 84);
  EXPECT_GT(*std::max_element(left.begin(), left.end()), 0);
  EXPECT_EQ(reader.readAsDouble("data/below/sensor_pose", 0, 1).size(), 7u);
  EXPECT_EQ(reader.readAsDouble("data/object_pose", 0, 1).size(), 7u);
  EXPECT_EQ(reader.readAsDouble("meta/target_force", 0, 7).size(), 14u);
  EXPECT_EQ(reader.readAsDouble("meta/episode", 6, 1)[0], 6);
}

TEST(GraspDataSet, RefusesWhatTheKindDoesNotHave) {
  const TestDirectory directory;
  GenerateOptions options;
  options.policy.emplace().id = "policy";
  EXPECT_THROW(generate(device(), scene(), directory.path() / "out", options), Error);
  EXPECT_FALSE(std::filesystem::exists(directory.path() / "out"));
}

// One finger opens, so that its first frame is its nearest; the other touches.
TEST(GraspDataSet, CountsFingersThatTouchNothing) {
  Scene opening = scene();
  opening.num_episodes = 3;
  opening.grasp->fingers[1].joints[0].velocity *= -1;
  const TestDirectory directory;
  const std::vector<ContactMisses> misses = generate(device(), opening, directory.path(), {.batch_size = 2}).contact_misses;
  ASSERT_EQ(misses.size(), 2u);
  EXPECT_EQ(misses[0].num_episodes, 3u);
  EXPECT_EQ(misses[0].num_misses, 0u);
  EXPECT_EQ(misses[1].num_episodes, 3u);
  EXPECT_EQ(misses[1].num_misses, 3u);
  // scenes/robots/gripper.urdf by hand: the highest corner of the array, 15 mm long, under the lower face of the box.
  const double bend = -20 * std::numbers::pi / 180, tip = 1.5 * bend - 0.1;
  EXPECT_NEAR(misses[1].nearest, -0.015 - (-0.02 + 0.03 * std::sin(bend) + 0.02 * std::sin(tip) - 0.0075 * std::sin(tip)), 1e-9);
}

}  // namespace
}  // namespace taxelsim
