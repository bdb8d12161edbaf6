// The columns of a data set agree with each other, with the draw of the episodes and with the scene.
#include "control/twist.h"
#include "episodes/draw.h"
#include "episodes/example_scene.h"
#include "episodes/true_edge.h"
#include "support/test.h"
#include "taxelsim/generate.h"

namespace taxelsim {
namespace {

GenerateResult generateWith(const Scene& scene, const std::filesystem::path& directory, int batch_size, int num_slices) {
  static const Device device = Device::open();
  return generate(device, scene, directory, {.batch_size = batch_size, .num_slices = num_slices, .on_progress = {}, .stop = nullptr});
}

// Integrating the actions gives the sensor poses, and the object rests in the world.
TEST(RecordedValues, ActionsIntegrateToSensorPosesAndTheObjectRests) {
  // Actions are float32, up to 1 rad/s and 0.02 m/s over 0.01 s; poses are double.
  constexpr double kActionRounding = 2 * 0x1p-24 * 0.01, kPoseRounding = 1e-14;
  const Scene scene = exampleScene();
  const TestDirectory directory;
  generateWith(scene, directory.path(), 8, 2);
  const DatasetReader reader(directory.path());
  ASSERT_EQ(reader.numFrames(), 23u * 7u);
  const auto column = [&](const std::string& name) { return reader.readAsDouble(name, 0, reader.numFrames()); };
  const std::vector<double> time = column("data/time"), action = column("data/action"), pose = column("data/pose"),
                            sensor_pose = column("data/sensor_pose");
  const auto poseAt = [](const std::vector<double>& values, std::size_t frame) {
    const double* p = &values[7 * frame];
    return Pose{{p[0], p[1], p[2]}, {p[3], p[4], p[5], p[6]}};
  };
  const auto expectNear = [](const Pose& a, const Pose& b, double tolerance) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(a.position[k], b.position[k], tolerance);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(a.rotation[k], b.rotation[k], tolerance);
  };

  bool any_motion = false;
  for (std::size_t frame = 0; frame < reader.numFrames(); ++frame) {
    const std::size_t step = frame % 7;
    EXPECT_NEAR(time[frame], static_cast<double>(step) * 0.01, 1e-15);
    const Pose X_WS = poseAt(sensor_pose, frame);
    if (step == 0) {
      expectNear(X_WS, Pose{}, 0);
      continue;
    }
    const double* a = &action[6 * (frame - 1)];
    if (step % 2 == 0) {  // 50 Hz control in a 100 Hz simulation: zero-order hold of each command over two frames
      for (int k = 0; k < 6; ++k) EXPECT_EQ(a[k], a[k - 6]) << frame;
    }
    for (int k = 0; k < 6; ++k) any_motion = any_motion || a[k] != 0;
    expectNear(poseAt(sensor_pose, frame - 1) * exponential({{a[0], a[1], a[2]}, {a[3], a[4], a[5]}}, 0.01), X_WS, kActionRounding);
    const Pose X_WO = X_WS * poseAt(pose, frame);
    expectNear(X_WO, poseAt(pose, frame - step), kPoseRounding);
  }
  EXPECT_TRUE(any_motion);
}

TEST(RecordedValues, EpisodeColumnsContainTheDraw) {
  const Scene scene = exampleContacts();
  const TestDirectory directory;
  generateWith(scene, directory.path(), 8, 2);
  const DatasetReader reader(directory.path());
  const auto column = [&](const std::string& name) { return reader.readAsDouble(name, 0, scene.num_episodes); };
  const std::vector<double> episode = column("meta/episode"), object = column("meta/object"), load = column("meta/load"),
                            driven = column("meta/load_driven"), depth = column("meta/depth"), reached = column("meta/load_reached"),
                            gain = column("meta/gain"), spread = column("meta/gain_spread"), noise = column("meta/noise"),
                            pose = column("data/pose");
  const EpisodeDrawer drawer(scene);
  for (std::uint64_t i = 0; i < scene.num_episodes; ++i) {
    const EpisodeDraw draw = drawer.draw(i);
    EXPECT_EQ(episode[i], i);
    EXPECT_EQ(object[i], draw.object);
    EXPECT_EQ(load[i], draw.load);
    EXPECT_EQ(driven[i], 1);
    EXPECT_EQ(reached[i], 1);
    EXPECT_EQ(gain[i], draw.variation.gain);
    EXPECT_EQ(spread[i], draw.variation.gain_spread);
    EXPECT_EQ(noise[i], draw.variation.noise);
    EXPECT_GT(depth[i], 0);
    EXPECT_LT(depth[i], scene.sensor.skin.thickness);
    // The pose after the load search: below first touch by the depth, a float32 column.
    EXPECT_NEAR(pose[7 * i + 2], draw.X_SO.position[2] - depth[i], scene.sensor.skin.thickness * 0x1p-24);
  }
}

// Poses are those in the sensor where it is, not where the robot believes it.
TEST(RecordedValues, SkinAndMountingHaveColumns) {
  Scene scene = exampleContacts();
  scene.sensor.readout.trigger = 0.02;
  Randomization& random = scene.randomization;
  random.stiffness = Range{0.6, 1.5};
  random.trigger = Range{0.5, 2};
  random.trigger_spread = Range{0.1, 0.6};
  random.mounting_x = Range{-5e-4, 5e-4};
  random.mounting_yaw = Range{-0.1, 0.1};
  const TestDirectory directory, other;
  generateWith(scene, directory.path(), 8, 2);
  const DatasetReader reader(directory.path());
  const auto column = [&](const std::string& name) { return reader.readAsDouble(name, 0, scene.num_episodes); };
  const std::vector<double> stiffness = column("meta/stiffness"), trigger = column("meta/trigger"), x = column("meta/mounting_x"),
                            yaw = column("meta/mounting_yaw"), spread = column("meta/trigger_spread"), depth = column("meta/depth"),
                            pose = column("data/pose");
  const EpisodeDrawer drawer(scene);
  for (std::uint64_t i = 0; i < scene.num_episodes; ++i) {
    const EpisodeDraw draw = drawer.draw(i);
    EXPECT_EQ(stiffness[i], draw.skin.stiffness);
    EXPECT_EQ(trigger[i], draw.skin.trigger);
    EXPECT_EQ(spread[i], draw.skin.trigger_spread);
    EXPECT_GE(spread[i], 0.1f);
    EXPECT_EQ(x[i], draw.mounting.x);
    EXPECT_EQ(yaw[i], draw.mounting.yaw);
    EXPECT_NE(draw.skin.stiffness, 1);
    const double* p = &pose[7 * i];
    const Pose X_NO = poseOf(draw.mounting) * Pose{{p[0], p[1], p[2]}, {p[3], p[4], p[5], p[6]}};
    const Vector3 expected{draw.X_SO.position[0], draw.X_SO.position[1], draw.X_SO.position[2] - depth[i]};  // a float32 column
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(X_NO.position[k], expected[k], scene.sensor.skin.thickness * 0x1p-24 + 1e-14);
  }
  generateWith(scene, other.path(), 3, 1);
  EXPECT_EQ(DatasetReader(other.path()).readAsDouble("data/tactile_image", 0, scene.num_episodes), column("data/tactile_image"))
      << "depends on the batch";
}

TEST(RecordedValues, NamesOfObjectsAndControllersAreThoseOfTheScene) {
  Scene scene = exampleScene();
  scene.controllers.push_back({.name = "second", .servo = scene.controllers[0].servo});
  const TestDirectory directory;
  generateWith(scene, directory.path(), 8, 2);
  const DatasetReader reader(directory.path());
  const std::vector<std::string> objects = reader.readAsText("meta/object_name", 0, scene.num_episodes),
                                 controllers = reader.readAsText("meta/controller_name", 0, scene.num_episodes);
  const EpisodeDrawer drawer(scene);
  for (std::uint64_t i = 0; i < scene.num_episodes; ++i) {
    const EpisodeDraw draw = drawer.draw(i);
    EXPECT_EQ(objects[i], scene.objects[static_cast<std::size_t>(draw.object)].object.name);
    EXPECT_EQ(controllers[i], scene.controllers[static_cast<std::size_t>(draw.controller)].name);
    EXPECT_EQ(reader.readAsDouble("meta/controller", i, 1)[0], draw.controller);
  }
}

TEST(RecordedValues, ExactEdgeAngleIsThatOfThePose) {
  Scene scene = exampleScene();
  scene.objects[0].edge = Vector3{0, 0, 1};  // axis of the bar
  const TestDirectory directory;
  generateWith(scene, directory.path(), 7, 2);
  const DatasetReader reader(directory.path());
  const auto column = [&](const char* name) { return reader.readAsDouble(name, 0, reader.numFrames()); };
  const std::vector<double> angle = column("data/ground_truth/exact_edge_angle"), known = column("data/ground_truth/exact_edge_known"),
                            pose = column("data/pose"), object = reader.readAsDouble("meta/object", 0, scene.num_episodes);
  const TrueEdge edge(scene.objects[0]);
  for (std::size_t frame = 0; frame < angle.size(); ++frame) {
    const double* p = &pose[7 * frame];
    const bool is_bar = object[frame / static_cast<std::size_t>(scene.num_steps)] == 0;
    EXPECT_EQ(known[frame], is_bar);
    EXPECT_EQ(angle[frame], is_bar ? static_cast<float>(edge.project({{p[0], p[1], p[2]}, {p[3], p[4], p[5], p[6]}}).angle) : 0.0f);
  }
}

TEST(RecordedValues, FlagsLoadsOutOfReach) {
  Scene scene = exampleContacts();
  scene.randomization.load = Range{1e5, 1e5};
  const TestDirectory directory;
  const GenerateResult result = generateWith(scene, directory.path(), 8, 2);
  EXPECT_TRUE(result.complete);
  EXPECT_EQ(result.num_load_misses, scene.num_episodes);
  for (const double reached : DatasetReader(directory.path()).readAsDouble("meta/load_reached", 0, scene.num_episodes)) {
    EXPECT_EQ(reached, 0);
  }
}

TEST(RecordedValues, DepthDrivenEpisodesHaveNoLoad) {
  Scene scene = exampleContacts();
  scene.randomization.load.reset();
  scene.randomization.depth = Range{0.5e-3, 0.5e-3};
  const TestDirectory directory;
  generateWith(scene, directory.path(), 8, 2);
  const DatasetReader reader(directory.path());
  for (std::uint64_t i = 0; i < scene.num_episodes; ++i) {
    EXPECT_EQ(reader.readAsDouble("meta/load", i, 1)[0], 0);
    EXPECT_EQ(reader.readAsDouble("meta/load_driven", i, 1)[0], 0);
    EXPECT_EQ(reader.readAsDouble("meta/load_reached", i, 1)[0], 1);
    EXPECT_EQ(reader.readAsDouble("meta/depth", i, 1)[0], static_cast<double>(0.5e-3f));
    EXPECT_GT(reader.readAsDouble("data/total_force", i, 1)[0], 0);
  }
}

}  // namespace
}  // namespace taxelsim
