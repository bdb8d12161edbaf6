// The block `robot` of a scene and robot files: the values read, and the message of each error.
#include "scene_text.h"
#include "support/test.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kRounding = 1e-15;
constexpr std::string_view kMount = "robot: {free_flying: {}}";  // line 14
const std::filesystem::path kRobots = std::filesystem::path(TAXELSIM_SOURCE_DIR) / "scenes/robots";

constexpr std::string_view kArm =
    "<robot name='arm'><link name='base'/><link name='upper'/><link name='tool'/>"
    "<joint name='turn' type='revolute'><parent link='base'/><child link='upper'/><axis xyz='0 0 1'/>"
    "<limit lower='-1' upper='2' effort='1' velocity='2'/></joint>"
    "<joint name='lift' type='prismatic'><parent link='upper'/><child link='tool'/><axis xyz='0 0 1'/>"
    "<limit lower='0' upper='0.5' effort='1' velocity='2'/></joint></robot>";

std::string withRobot(const std::string& robot) {
  return edited(kScene, kMount, "robot: " + robot);
}

class RobotFile : public ::testing::Test {
 protected:
  RobotFile() {
    directory.write("arm.urdf", kArm);
    directory.write("not.urdf", "<robot");
  }
  Scene load(const std::string& robot) const { return loadScene(directory.write("scene.yaml", withRobot(robot))); }
  Manipulator manipulator(const std::string& robot) const { return std::get<Manipulator>(load(robot).robot); }
  std::string refusalOf(const std::string& robot) const {
    const std::filesystem::path file = directory.write("scene.yaml", withRobot(robot));
    return refusal(file, [&] { loadScene(file); });
  }

  testing::TemporaryDirectory directory;
};

TEST_F(RobotFile, HasAFreeFlyingSensorWithoutTheBlock) {
  const Scene scene = loadScene(directory.write("scene.yaml", kScene));
  EXPECT_TRUE(std::holds_alternative<FreeFlying>(scene.robot));
  EXPECT_EQ(load("{free_flying: {}}").resolved, loadScene(directory.write("scene.yaml", edited(kScene, kMount, ""))).resolved);
}

TEST_F(RobotFile, HasDefaultsOfAPanTiltPlatform) {
  const Manipulator robot = manipulator("{pan_tilt: {}}");
  ASSERT_EQ(robot.joints.size(), 2u);
  EXPECT_EQ(robot.joints[0].name, "pan");
  EXPECT_NEAR(robot.joints[1].upper, 150 * kDegree, kRounding);
  EXPECT_NEAR(robot.joints[1].max_velocity, 354 * kDegree, 10 * kRounding);
  EXPECT_NEAR(robot.drive.position_step, 0.29 * kDegree, kRounding);
  EXPECT_EQ(robot.selection, (std::array<bool, 6>{false, false, false, false, true, true}));
  EXPECT_EQ(robot.sensors.size(), 1u);
}

TEST_F(RobotFile, ReadsEverySettingOfAPanTiltPlatform) {
  const Manipulator robot = manipulator(
      "{pan_tilt: {tilt_height_mm: 70, position_limits_deg: [-90, 60], max_velocity_deg: 180, position_step_deg: 1, delay: 3,\n"
      "  sensors: [{link: tilt}, {link: pan, mount: {position_mm: [1, 2, 3]}}], selection: [wz, wx], max_damping: 0.1,\n"
      "  singular_threshold: 0.2, base: {position: [1, 0, 0]}, initial_positions: [{joint: tilt, position_deg: 30}]}}");
  EXPECT_EQ(robot.sensors[1].link, "pan");
  EXPECT_EQ(robot.sensors[1].X_JS.position, (Vector3{0.001, 0.002, 0.003}));
  EXPECT_EQ(robot.sensors[0].chain[1].X_PJ.position, (Vector3{0, 0, 0.07}));
  EXPECT_NEAR(robot.joints[0].lower, -90 * kDegree, kRounding);
  EXPECT_NEAR(robot.joints[1].initial_position, 30 * kDegree, kRounding);
  EXPECT_EQ(robot.joints[0].initial_position, 0);
  EXPECT_NEAR(robot.joints[0].max_velocity, std::numbers::pi, kRounding);
  EXPECT_EQ(robot.drive.delay, 3);
  EXPECT_EQ(robot.selection, (std::array<bool, 6>{false, false, false, true, false, true}));
  EXPECT_EQ(robot.max_damping, 0.1);
  EXPECT_EQ(robot.singular_threshold, 0.2);
  EXPECT_EQ(robot.X_WB.position, (Vector3{1, 0, 0}));
}

TEST_F(RobotFile, ReadsAnArmFromAUrdfFile) {
  const Manipulator robot = manipulator(
      "{urdf: {file: arm.urdf, base_link: base, velocity_limit_scale: 0.5, sensors: [{link: tool, mount: {position_mm: [0, 0, 10]}}], "
      "delay: 2,\n"
      "  initial_positions: [{joint: lift, position_mm: 100}, {joint: turn, position_deg: 45}]}}");
  ASSERT_EQ(robot.joints.size(), 2u);
  EXPECT_EQ(robot.joints[0].name, "turn");
  EXPECT_EQ(robot.joints[0].max_velocity, 1);
  EXPECT_NEAR(robot.joints[0].initial_position, 45 * kDegree, kRounding);
  EXPECT_EQ(robot.joints[1].initial_position, 0.1);
  EXPECT_EQ(robot.drive.position_step, 0);
  EXPECT_EQ(robot.drive.delay, 2);
}

TEST_F(RobotFile, ReadsRobotFiles) {
  directory.write("robots/arm.urdf", kArm);
  directory.write("robots/arm.yaml", "format_version: 1\nurdf: {file: arm.urdf, sensors: [{link: tool}]}\n");
  EXPECT_EQ(load("robots/arm.yaml").resolved, load("{urdf: {file: arm.urdf, sensors: [{link: tool}]}}").resolved);
  const std::filesystem::path bad = directory.write("robots/arm.yaml", "format_version: 1\nurdf: {file: arm.urdf}\n");
  EXPECT_THAT(refusalOf("robots/arm.yaml"), ::testing::StartsWith(bad.string() + ":2:7: urdf: sensors is missing: a list of at least one"));
  directory.write("robots/arm.yaml", "format_version: 2\n");
  EXPECT_THAT(refusalOf("robots/arm.yaml"), ::testing::HasSubstr("arm.yaml:1:17: format_version: version 2 is newer than this program"));
}

TEST_F(RobotFile, ShippedRobotsLoad) {
  int num_files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kRobots)) {
    // Hands have sensors of their own; the scenes of kind grasp load them.
    const std::string name = entry.path().stem().string();
    const bool is_hand = name.ends_with("_hand") || name == "gripper";
    if (entry.path().extension() != ".yaml" || is_hand) continue;
    ++num_files;
    const Scene scene = load(entry.path().string());
    EXPECT_EQ(scene.resolved.find(TAXELSIM_SOURCE_DIR), std::string::npos) << "contains a path of this machine";
    EXPECT_TRUE(std::holds_alternative<Manipulator>(scene.robot));
  }
  EXPECT_EQ(num_files, 2);
  // The file of the platform states the defaults in degrees, which rounds them.
  const Manipulator shipped = manipulator((kRobots / "pan_tilt.yaml").string()), standard = panTilt({});
  EXPECT_NEAR(shipped.joints[0].max_velocity, standard.joints[0].max_velocity, 10 * kRounding);
  EXPECT_NEAR(shipped.joints[0].upper, standard.joints[0].upper, kRounding);
  EXPECT_EQ(shipped.drive.position_step, standard.drive.position_step);
  EXPECT_EQ(shipped.sensors[0].X_JS, standard.sensors[0].X_JS);
  EXPECT_EQ(shipped.selection, standard.selection);
}

TEST_F(RobotFile, ResolvedSceneHasEverySetting) {
  directory.write("other/arm.urdf", std::string(kArm) + "<!-- another -->");
  const std::string urdf = "{urdf: {file: arm.urdf, sensors: [{link: tool}]";
  std::set<std::string> texts;
  for (const std::string& robot : std::vector<std::string>{"{free_flying: {}}",
                                                           "{pan_tilt: {}}",
                                                           "{pan_tilt: {tilt_height: 0.1}}",
                                                           "{pan_tilt: {position_limits: [-1, 1]}}",
                                                           "{pan_tilt: {max_velocity: 1}}",
                                                           "{pan_tilt: {position_step: 0.1}}",
                                                           "{pan_tilt: {delay: 1}}",
                                                           "{pan_tilt: {sensors: [{link: pan}]}}",
                                                           "{pan_tilt: {sensors: [{link: tilt}, {link: pan}]}}",
                                                           "{pan_tilt: {sensors: [{link: tilt, mount: {rpy: [1, 0, 0]}}]}}",
                                                           "{pan_tilt: {selection: [wz]}}",
                                                           "{pan_tilt: {max_damping: 1}}",
                                                           "{pan_tilt: {singular_threshold: 0.5}}",
                                                           "{pan_tilt: {base: {position: [0, 0, 1]}}}",
                                                           "{pan_tilt: {initial_positions: [{joint: pan, position: 1}]}}",
                                                           urdf + "}}",
                                                           urdf + ", base_link: upper}}",
                                                           urdf + ", velocity_limit_scale: 0.5}}",
                                                           urdf + ", position_step: 0.1}}",
                                                           urdf + ", delay: 1}}",
                                                           urdf + ", selection: [wz, vz]}}",
                                                           urdf + ", initial_positions: [{joint: lift, position: 0.2}]}}",
                                                           "{urdf: {file: other/arm.urdf, sensors: [{link: tool}]}}"}) {
    const std::string text = load(robot).resolved;
    EXPECT_TRUE(texts.insert(text).second) << robot;
    // The canonical text refers to files in its own directory.
    const testing::TemporaryDirectory folder;
    folder.write("arm.urdf", robot.find("other") == std::string::npos ? std::string(kArm) : std::string(kArm) + "<!-- another -->");
    EXPECT_EQ(loadScene(folder.write("resolved.yaml", text)).resolved, text) << robot;
  }
}

TEST_F(RobotFile, RejectsBadBlocks) {
  const std::vector<std::pair<std::string, std::string>> table = {
      {"{}", ":14:8: robot: exactly one of free_flying | pan_tilt | urdf"},
      {"{free_flying: {}, pan_tilt: {}}", ":14:36: robot.pan_tilt: conflicts with `free_flying`: exactly one of free_flying"},
      {"[]", ":14:8: robot: a list of 0 is not allowed: a robot file, or a robot's own settings"},
      {"none.yaml", ":14:8: robot: "},
      {"{walking: {}}", ":14:9: robot.walking: unknown key; allowed: free_flying, pan_tilt, urdf"},
      {"{free_flying: {speed: 1}}", ":14:23: robot.free_flying.speed: unknown key; no key is allowed here"},
      {"{pan_tilt: {pan_height: 1}}", ":14:20: robot.pan_tilt.pan_height: unknown key"},
      {"{pan_tilt: {max_velocity: 0}}", ":14:34: robot.pan_tilt.max_velocity: 0 is not allowed: a number > 0 rad/s"},
      {"{pan_tilt: {position_limits_deg: [10, -10]}}",
       ":14:41: robot.pan_tilt.position_limits_deg: [0.17453292519943295, -0.17453292519943295] rad is not allowed: [min, max]"},
      {"{pan_tilt: {position_limits_deg: [10, 20]}}",
       ":14:19: robot.pan_tilt: joints[0].initial_position: 0 is not allowed: a number from 0.17"},
      {"{pan_tilt: {position_step: -1}}", ":14:35: robot.pan_tilt.position_step: -1 is not allowed: a number >= 0 rad"},
      {"{pan_tilt: {delay: 1001}}", ":14:27: robot.pan_tilt.delay: 1001 is not allowed: a whole number from 0 to 1000"},
      {"{pan_tilt: {sensors: []}}", ":14:29: robot.pan_tilt.sensors: a list of 0 is not allowed: a list of at least one {link, mount}"},
      {"{pan_tilt: {sensors: [{}]}}", ":14:30: robot.pan_tilt.sensors[0]: link is missing: the name of a link"},
      {"{pan_tilt: {sensors: [{link: roll}]}}", ":14:19: robot.pan_tilt: no link roll: allowed are base, pan and tilt"},
      {"{pan_tilt: {selection: []}}", ":14:31: robot.pan_tilt.selection: a list of 0 is not allowed: a list of at least one of vx, vy"},
      {"{pan_tilt: {selection: [wq]}}", ":14:32: robot.pan_tilt.selection[0]: wq is not allowed: vx | vy | vz | wx | wy | wz"},
      {"{pan_tilt: {selection: [wz, wz]}}", ":14:36: robot.pan_tilt.selection[1]: wz is given twice"},
      {"{pan_tilt: {max_damping: 0}}", ":14:33: robot.pan_tilt.max_damping: 0 is not allowed: a number > 0"},
      {"{pan_tilt: {singular_threshold: 2}}", ":14:40: robot.pan_tilt.singular_threshold: 2 is not allowed: a number > 0 and <= 1"},
      {"{pan_tilt: {initial_positions: [{joint: roll, position: 0}]}}",
       ":14:48: robot.pan_tilt.initial_positions[0].joint: no joint roll moves a sensor: pan, tilt"},
      {"{pan_tilt: {initial_positions: [{position: 0}]}}",
       ":14:40: robot.pan_tilt.initial_positions[0]: joint is missing: the name of a joint"},
      {"{pan_tilt: {initial_positions: [{joint: pan, position_deg: 170}]}}",
       ":14:67: robot.pan_tilt.initial_positions[0].position_deg: 170 is not allowed: a number from -150 to 150 deg"},
      {"{pan_tilt: {initial_positions: [{joint: pan, position: 0}, {joint: pan, position: 1}]}}",
       ":14:67: robot.pan_tilt.initial_positions[1]: joint pan is given twice"},
      {"{pan_tilt: {initial_positions: [{joint: pan, position: nan}]}}",
       ":14:63: robot.pan_tilt.initial_positions[0].position: nan is not"},
      {"{urdf: {}}", ":14:15: robot.urdf: file is missing: a URDF file"},
      {"{urdf: {file: none.urdf}}", ":14:22: robot.urdf.file: "},
      {"{urdf: {file: not.urdf, sensors: [{link: tool}]}}", ":14:15: robot.urdf: "},
      {"{urdf: {file: arm.urdf}}", ":14:15: robot.urdf: sensors is missing: a list of at least one {link, mount}"},
      {"{urdf: {file: arm.urdf, sensors: [{link: hand}]}}", ":14:15: robot.urdf: "},
      {"{urdf: {file: arm.urdf, base_link: foot, sensors: [{link: tool}]}}", ":14:15: robot.urdf: "},
      {"{urdf: {file: arm.urdf, sensors: [{link: base}]}}", ":14:15: robot.urdf: "},
      {"{urdf: {file: arm.urdf, velocity_limit_scale: 2, sensors: [{link: tool}]}}",
       ":14:54: robot.urdf.velocity_limit_scale: 2 is not allowed: a number > 0 and <= 1"},
      {"{urdf: {file: arm.urdf, sha256: '00', sensors: [{link: tool}]}}", ":14:40: robot.urdf.sha256: not the SHA-256 of"},
      {"{urdf: {file: arm.urdf, sensors: [{link: tool}], initial_positions: [{joint: lift, position_deg: 1}]}}",
       ":14:91: robot.urdf.initial_positions[0].position_deg: unknown key, did you mean 'position_mm'?"},
  };
  for (const auto& [robot, message] : table) EXPECT_THAT(refusalOf(robot), ::testing::StartsWith(message)) << robot;
}

TEST_F(RobotFile, RejectsRobotsInScenesOfContacts) {
  std::string text = edited(withRobot("{pan_tilt: {}}"), "kind: servo", "kind: contacts");
  text = edited(edited(text, "num_steps: 20, ", ""), "controller:\n  tactile_servo: {edge_angle: {kp: 0.78}}\n", "");
  const std::filesystem::path file = directory.write("scene.yaml", text);
  EXPECT_THAT(refusal(file, [&] { loadScene(file); }),
              ::testing::StartsWith(":14:8: robot: a scene of kind contacts has one frame, in which nothing moves"));
}

}  // namespace
}  // namespace taxelsim
