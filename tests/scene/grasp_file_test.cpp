// Scenes of kind grasp: what their files may say, one clear line for anything else.
#include "scene/scene_checks.h"
#include "scene_text.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kScenes = std::filesystem::path(TAXELSIM_SOURCE_DIR) / "scenes";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// The files that the gripper's scene names.
void copyParts(const testing::TemporaryDirectory& directory) {
  for (const char* const folder : {"robots", "sensors"}) std::filesystem::create_directory(directory.path() / folder);
  for (const char* const file : {"sensors/fingertip_6x4.yaml", "sensors/wts0614_soft_cover.yaml", "sensors/wts0614_proximity.yaml",
                                 "robots/gripper.urdf", "robots/pan_tilt.yaml"}) {
    std::filesystem::copy_file(kScenes / file, directory.path() / file);
  }
  directory.write("robots/gripper.yaml", testing::contentOf(kScenes / "robots/gripper.yaml"));
}

// The message for the gripper's scene and robot after one change each.
std::string refusalOf(const std::string& scene_from, const std::string& scene_to, const std::string& robot_from = "name",
                      const std::string& robot_to = "name") {
  const testing::TemporaryDirectory directory;
  copyParts(directory);
  directory.write("robots/gripper.yaml", replaced(testing::contentOf(kScenes / "robots/gripper.yaml"), robot_from, robot_to));
  const std::filesystem::path file =
      directory.write("scene.yaml", replaced(testing::contentOf(kScenes / "gripper_grasp.yaml"), scene_from, scene_to));
  try {
    loadScene(file);
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos);
    EXPECT_THAT(message, HasSubstr(".yaml:"));
    return message;
  }
  return "was accepted";
}

std::string robotRefusal(const std::string& from, const std::string& to) {
  return refusalOf("name", "name", from, to);
}

TEST(GraspScene, LoadsAndItsResolvedTextIsItself) {
  const Scene scene = loadScene(kScenes / "shadow_grasp.yaml");
  ASSERT_TRUE(scene.grasp.has_value());
  EXPECT_EQ(scene.kind, Scene::Kind::kGrasp);
  EXPECT_EQ(scene.grasp->sensors.size(), 6u);
  EXPECT_EQ(scene.grasp->sensors[0].name, "palm");
  EXPECT_EQ(scene.grasp->sensors[1].text, scene.grasp->sensors[5].text);
  EXPECT_EQ(scene.objects.size(), 2u);
  const testing::TemporaryDirectory directory;
  std::filesystem::copy_file(kScenes / "robots/shadow_hand.urdf", directory.path() / "shadow_hand.urdf");
  EXPECT_EQ(loadScene(directory.write("scene.yaml", scene.resolved)).resolved, scene.resolved);
}

// A condition overrides the robot and the readout's randomization; the text of the nominal scene stays.
TEST(GraspScene, HasConditions) {
  const testing::TemporaryDirectory directory;
  copyParts(directory);
  const std::string robot = testing::contentOf(kScenes / "robots/gripper.yaml"), text = testing::contentOf(kScenes / "gripper_grasp.yaml");
  directory.write("robots/other.yaml", replaced(robot, "position_mm: [20", "position_mm: [19"));
  directory.write("scene.yaml", replaced(text, "unseen: {", "unseen: {robot: robots/other.yaml, "));
  const Scene nominal = loadScene(directory.path() / "scene.yaml");
  EXPECT_EQ(nominal.conditions, (std::vector<std::string>{"randomized", "unseen"}));
  EXPECT_EQ(nominal.randomization.gain.max, 1);
  EXPECT_THAT(nominal.resolved, HasSubstr("randomization:\n  offset: 0\n  yaw: 0\n  force_spread: 0.3\nrecord"));
  const Scene unseen = loadScene(directory.path() / "scene.yaml", {.condition = "unseen"});
  EXPECT_EQ(unseen.randomization.gain.max, 1.4);
  EXPECT_EQ(unseen.randomization.noise.min, 25);
  EXPECT_EQ(unseen.grasp->force_spread, 0.3);
  EXPECT_NEAR(std::get<Manipulator>(unseen.robot).sensors[2].X_JS.position[0], 0.019, 1e-15);
  EXPECT_EQ(loadScene(directory.write("robots/resolved.yaml", unseen.resolved)).resolved, unseen.resolved);
  EXPECT_THAT(refusalOf("unseen: {", "unseen: {sensor: x.yaml, "), HasSubstr("unknown key"));
  EXPECT_THAT(refusalOf("noise: [25, 40]", "noise: [40, 25]"), HasSubstr("min > max"));
  EXPECT_THAT(refusalOf("unseen: {", "unseen: {robot: robots/pan_tilt.yaml, "), HasSubstr(".yaml:"));
  directory.write("robots/other.yaml", replaced(robot, "name: below", "name: under"));
  EXPECT_THAT(support::refusal([&] { loadScene(directory.path() / "scene.yaml"); }),
              HasSubstr("in condition unseen its sensors and their taxels are not those of the scene's own robot"));
}

TEST(GraspScene, RefusesBadScenes) {
  EXPECT_EQ(refusalOf("name", "name"), "was accepted");
  EXPECT_THAT(refusalOf("sensor: left", "sensor: lft"), HasSubstr("sensor: no sensor lft: left, right, below"));
  EXPECT_THAT(refusalOf("joint: jaw", "joint: jw"), HasSubstr("joint: no joint jw: jaw, bend"));
  EXPECT_THAT(refusalOf("joint: bend, velocity_deg: 60", "joint: jaw, velocity_mm: 6"), HasSubstr("jaw is given twice"));
  EXPECT_THAT(refusalOf("joint: bend, velocity_deg", "joint: bend, velocity_mm"), HasSubstr("unknown key"));
  EXPECT_THAT(refusalOf("velocity_mm: 50", "velocity_mm: 0"), HasSubstr("velocity_mm: 0 is not allowed"));
  EXPECT_THAT(refusalOf("velocity_mm: 50", "velocity_mm: 101"), HasSubstr("101 is not allowed"));
  EXPECT_THAT(refusalOf("velocity_mm: 50", "velocity_mm: -50"),
              HasSubstr("joints: the finger cannot close: joint jaw starts at its lower limit 0, towards which its velocity points"));
  EXPECT_THAT(
      refusalOf("joints: [{joint: jaw, velocity_mm: 50}]}\n    - {sensor: below, force: 0.5, joints: [{joint: bend, velocity_deg: 60}]}",
                "joints: [{joint: bend, velocity_deg: 60}]}\n    - {sensor: below, force: 0.5, joints: [{joint: jaw, velocity_mm: 50}]}"),
      HasSubstr("joints: no joint of the list moves the sensor left"));
  EXPECT_THAT(refusalOf("force: 2", "force: 0"), HasSubstr("force: 0 is not allowed"));
  EXPECT_THAT(refusalOf("sensor: below", "sensor: left"), HasSubstr("an earlier finger has this sensor"));
  EXPECT_THAT(refusalOf("[{joint: jaw, velocity_mm: 50}]", "[]"), HasSubstr("joints: a list of 0 is not allowed"));
  EXPECT_THAT(refusalOf("  fingers:", "  gain: 101\n  fingers:"), HasSubstr("gain: 101 is not allowed"));
  EXPECT_EQ(refusalOf("num_steps: 150", "num_steps: 150, control_rate: 50"), "was accepted");
  EXPECT_THAT(refusalOf("num_steps: 150", "num_steps: 150, control_rate: 40"), HasSubstr("control_rate"));
  EXPECT_THAT(refusalOf("objects:", "record: [poses]\nobjects:"), HasSubstr("always records"));
  EXPECT_THAT(refusalOf("objects:", "record: [taxel_counts]\nobjects:"),
              HasSubstr("record: taxel_counts needs readout.three_axis of the sensor "));
  EXPECT_THAT(refusalOf("objects:", "sensor: sensors/fingertip_6x4.yaml\nobjects:"), HasSubstr("unknown key"));
  EXPECT_THAT(refusalOf("box: {size_mm: [60, 30, 30]}", "box: {size_mm: [60, 30, 30]}\n    weight: 2"), HasSubstr("unknown key"));
  EXPECT_THAT(refusalOf("robots/gripper.yaml", "{free_flying: {}}"), HasSubstr("a robot with joints"));
  EXPECT_THAT(refusalOf("robots/gripper.yaml", "robots/pan_tilt.yaml"), HasSubstr("name is missing"));
  std::string objects = "objects:\n";
  for (int k = 0; k < 8; ++k) objects += "  - sphere: {radius_mm: 5}\n";
  EXPECT_THAT(refusalOf("objects:\n", objects), HasSubstr("objects: 9 objects are not allowed: at most 8"));
}

// The gripper whose jaws follow the palm servo of its right sensor, after one change.
std::string servoRefusal(const std::string& from, const std::string& to) {
  const std::string left = "    - {sensor: left, force: 2, joints: [{joint: jaw, velocity_mm: 50}]}\n";
  const std::string below = "    - {sensor: below, force: 0.5, joints: [{joint: bend, velocity_deg: 60}]}\n";
  const std::string servo = "  servo:\n    sensor: right\n    joints: [jaw]\n    tactile_servo: {total_force: {reference: 2, kp: 5}}\n";
  return refusalOf(left + below, replaced(below + servo, from, to));
}

TEST(GraspScene, ReadsItsTask) {
  const Scene plain = loadScene(kScenes / "gripper_grasp.yaml");
  EXPECT_EQ(plain.grasp->task.tolerance, 0.1);
  EXPECT_EQ(plain.grasp->task.hold, 0.5);
  EXPECT_FALSE(plain.grasp->task.drift);
  EXPECT_EQ(plain.resolved.find("task"), std::string::npos);  // the text of a scene without a task is that of its data sets so far
  const testing::TemporaryDirectory directory;
  copyParts(directory);
  const std::string given = testing::contentOf(kScenes / "gripper_grasp.yaml") + "task: {tolerance: 0.05, hold: 1, drift_mm: 0.5}\n";
  const Scene scene = loadScene(directory.write("scene.yaml", given));
  EXPECT_EQ(scene.grasp->task.tolerance, 0.05);
  EXPECT_EQ(scene.grasp->task.hold, 1);
  EXPECT_DOUBLE_EQ(*scene.grasp->task.drift, 0.5e-3);
  const Scene again = loadScene(directory.write("robots/resolved.yaml", scene.resolved));  // next to the URDF
  EXPECT_EQ(again.resolved, scene.resolved);
}

TEST(GraspScene, RefusesBadTasks) {
  const auto refusal = [](const std::string& task) { return refusalOf("objects:\n", "task: {" + task + "}\nobjects:\n"); };
  EXPECT_EQ(refusal(""), "was accepted");
  EXPECT_THAT(refusal("tolerance: 0"), HasSubstr("task.tolerance: 0 is not allowed: a number > 0 and <= 1"));
  EXPECT_THAT(refusal("hold: 1.6"), HasSubstr("task.hold: 1.6 is not allowed: a number > 0 and <= 1.5 s, the duration of an episode"));
  EXPECT_THAT(refusal("drift_mm: 0"), HasSubstr("task.drift_mm: 0 is not allowed"));
  EXPECT_THAT(refusal("laps: 1"), HasSubstr("unknown key"));
}

TEST(GraspScene, RefusesBadServos) {
  EXPECT_EQ(servoRefusal("right", "right"), "was accepted");
  EXPECT_THAT(servoRefusal("sensor: right", "sensor: rght"), HasSubstr("grasp.servo.sensor: no sensor rght: left, right, below"));
  EXPECT_THAT(servoRefusal("sensor: right", "sensor: below"), HasSubstr("grasp.servo.sensor: a finger has this sensor"));
  EXPECT_THAT(servoRefusal("    sensor: right\n", ""), HasSubstr("sensor is missing"));
  EXPECT_THAT(servoRefusal("[jaw]", "[jaw, jw]"), HasSubstr("grasp.servo.joints[1]: no joint jw: jaw, bend"));
  EXPECT_THAT(servoRefusal("[jaw]", "[jaw, bend]"), HasSubstr("joints[1]: joint bend belongs to a finger"));
  EXPECT_THAT(servoRefusal("[jaw]", "[jaw, jaw]"), HasSubstr("joints[1]: joint jaw is given twice"));
  EXPECT_THAT(servoRefusal("[jaw]", "[]"), HasSubstr("joints: a list of 0 is not allowed: a list of at least one"));
  EXPECT_THAT(servoRefusal("    joints: [jaw]\n", ""), HasSubstr("joints is missing"));
  EXPECT_THAT(servoRefusal("kp: 5", "kp: -5"), HasSubstr("tactile_servo.total_force.kp: -5 is not allowed"));
  EXPECT_THAT(servoRefusal("{total_force: {reference: 2, kp: 5}}", "{}"), HasSubstr("no feature to control"));
  EXPECT_THAT(servoRefusal("kp: 5}}", "kp: 5}, edge_angle_source: exact}"),
              HasSubstr("tactile_servo.edge_angle_source: exact is not allowed: principal_axis, window or ridge"));
  EXPECT_THAT(servoRefusal("tactile_servo:", "tactile_srvo:"), HasSubstr("unknown key"));
}

// A joint that moves another sensor only.
TEST(GraspScene, RefusesServoJointsThatDoNotMoveTheSensor) {
  const std::string below = "    - {sensor: below, force: 0.5, joints: [{joint: bend, velocity_deg: 60}]}\n";
  EXPECT_THAT(refusalOf(below, "  servo: {sensor: right, joints: [bend], tactile_servo: {total_force: {kp: 5}}}\n"),
              HasSubstr("grasp.servo.joints[0]: joint bend does not move the sensor right"));
}

TEST(GraspScene, ReadsTheServoOfThePalm) {
  const Scene scene = loadScene(kScenes / "experiments/paper/arm_hand_given_scene.yaml");
  ASSERT_TRUE(scene.grasp.has_value() && scene.grasp->servo.has_value());
  const GraspServo& servo = *scene.grasp->servo;
  const auto& robot = std::get<Manipulator>(scene.robot);
  EXPECT_EQ(scene.grasp->sensors[static_cast<std::size_t>(servo.sensor)].name, "palm");
  ASSERT_EQ(servo.joints.size(), 7u);
  for (std::size_t k = 0; k < 7; ++k) {
    EXPECT_EQ(robot.joints[static_cast<std::size_t>(servo.joints[k])].name, "a" + std::to_string(k + 1));
  }
  EXPECT_EQ(servo.servo[ServoFeature::kTotalForce].ki, 150);
  EXPECT_EQ(servo.servo.edge_angle_source, EdgeAngleSource::kWindow);
  const testing::TemporaryDirectory directory;
  std::filesystem::copy_file(kScenes / "robots/lwr_shadow_hand.urdf", directory.path() / "lwr_shadow_hand.urdf");
  EXPECT_EQ(loadScene(directory.write("scene.yaml", scene.resolved)).resolved, scene.resolved);
}

// Scenes of programs, which no reader has checked.
TEST(GraspScene, ChecksTheServoOfAProgram) {
  Scene scene = loadScene(kScenes / "experiments/paper/arm_hand_rest_scene.yaml");
  checkScene(scene);
  const auto message = [&] { return support::refusal([&] { checkScene(scene); }); };
  TactileServo& servo = scene.grasp->servo->servo;
  servo.edge_angle_source = EdgeAngleSource::kExact;
  EXPECT_THAT(message(), HasSubstr("grasp.servo.tactile_servo.edge_angle_source: exact is not allowed"));
  servo = TactileServo{};
  EXPECT_THAT(message(), HasSubstr("no feature to control"));
}

TEST(GraspScene, RefusesBadRobots) {
  EXPECT_THAT(robotRefusal("link: tip", "link: tp"), HasSubstr("no link tp"));
  EXPECT_THAT(robotRefusal("fingertip_6x4.yaml", "missing.yaml"), HasSubstr("missing.yaml is not there"));
  EXPECT_THAT(robotRefusal("name: right", "name: left"), HasSubstr("an earlier sensor is named left"));
  EXPECT_THAT(robotRefusal("name: right", "name: ri/ght"), HasSubstr("letters, digits and _"));
  EXPECT_THAT(robotRefusal("name: right", "name: time"), HasSubstr("data sets have a column"));
  EXPECT_THAT(robotRefusal("fingertip_6x4.yaml", "wts0614_proximity.yaml"), HasSubstr("proximity has no forces"));
  EXPECT_THAT(robotRefusal("name: right, ", ""), HasSubstr("name is missing"));
}

// The gripper, whose first sensor has the place that the URDF gives it.
std::string gripperWith(const testing::TemporaryDirectory& directory, const std::string& place, const std::string& sensor) {
  std::filesystem::create_directory(directory.path() / "robots");
  std::filesystem::create_directory(directory.path() / "sensors");
  for (const char* const file : {"sensors/fingertip_6x4.yaml", "sensors/wts0614_soft_cover.yaml"})
    std::filesystem::copy_file(kScenes / file, directory.path() / file);
  directory.write("robots/gripper.urdf", replaced(testing::contentOf(kScenes / "robots/gripper.urdf"), "</robot>", sensor + "</robot>"));
  directory.write("robots/gripper.yaml",
                  replaced(testing::contentOf(kScenes / "robots/gripper.yaml"), "link: left_jaw, mount: {rpy_deg: [90, 0, 0]}", place));
  return directory.write("scene.yaml", testing::contentOf(kScenes / "gripper_grasp.yaml"));
}

TEST(GraspScene, MountsAreReadFromTheTactileSensorsOfAUrdf) {
  const testing::TemporaryDirectory directory;
  const std::string array = R"(<tactile channel="c"><array rows="6" cols="4" size="0.0025 0.0025"/></tactile></sensor>)";
  const std::string file = gripperWith(directory, "urdf_sensor: pad",
                                       R"(<sensor name="pad"><parent link="right_jaw"/><origin xyz="0.1 0 0" rpy="0 0 1"/>)" + array);
  const Scene scene = loadScene(file);
  const auto& robot = std::get<Manipulator>(scene.robot);
  EXPECT_EQ(robot.sensors[0].link, "right_jaw");
  const Manipulator plain = std::get<Manipulator>(loadScene(kScenes / "gripper_grasp.yaml").robot);
  const Pose X_RL = plain.sensors[1].X_JS * inverse(Pose{{}, axisAngle({1, 0, 0}, -std::numbers::pi / 2)});  // from rpy_deg [-90, 0, 0]
  const Pose expected = X_RL * Pose{{0.1, 0, 0}, axisAngle({0, 0, 1}, 1)};
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(robot.sensors[0].X_JS.position[axis], expected.position[axis], 1e-12);
  double cosine = 0;
  for (std::size_t k = 0; k < 4; ++k) cosine += robot.sensors[0].X_JS.rotation[k] * expected.rotation[k];
  EXPECT_NEAR(std::abs(cosine), 1, 1e-12);
  EXPECT_THAT(scene.resolved, HasSubstr("link: right_jaw"));  // resolved scenes read no URDF for it
}

TEST(GraspScene, RefusesBadMountsOfAUrdf) {
  const auto message = [](const std::string& place, const std::string& sensor) {
    const testing::TemporaryDirectory directory;
    const std::string file = gripperWith(directory, place, sensor);
    return support::refusal([&] { loadScene(file); });
  };
  const std::string tactile = R"(<tactile><array rows="6" cols="4" size="0.0025 0.0025"/></tactile></sensor>)";
  EXPECT_THAT(message("urdf_sensor: pad", ""), HasSubstr("has no tactile sensor pad"));
  EXPECT_THAT(message("urdf_sensor: pad", R"(<sensor name="pad">)" + tactile), HasSubstr("pad has no <parent link>"));
  EXPECT_THAT(message("urdf_sensor: pad", R"(<sensor name="pad"><parent link="jw"/>)" + tactile), HasSubstr("no link jw"));
  EXPECT_THAT(message("urdf_sensor: pad", R"(<sensor name="pad"><parent link="tip"/><origin xyz="1 2"/>)" + tactile), HasSubstr("xyz"));
  EXPECT_THAT(message("urdf_sensor: pad, link: tip", R"(<sensor name="pad"><parent link="tip"/>)" + tactile),
              HasSubstr("not allowed with link"));
}

TEST(GraspScene, RobotsWithSensorsAreForThisKindOnly) {
  const testing::TemporaryDirectory directory;
  const std::string text = edited(kScene, "robot: {free_flying: {}}", "robot: " + (kScenes / "robots/gripper.yaml").string());
  const std::filesystem::path file = directory.write("scene.yaml", text);
  directory.write("mesh.obj", kMeshText);
  EXPECT_THAT(refusal(kScenes / "robots/gripper.yaml", [&] { loadScene(file); }), HasSubstr("only a scene of kind grasp"));
}

}  // namespace
}  // namespace taxelsim
