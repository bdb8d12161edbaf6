// Loops of robots with joints that the device closes give the same bytes as the host's.
#include "control/robots.h"
#include "device_servo_cases.h"
#include "support/test.h"
#include "taxelsim/dataset.h"

namespace taxelsim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// KUKA LWR with a sensor on its palm. `bend`: of its elbow, rad; at 0 the arm is stretched, which is singular.
Manipulator arm(double bend = -1.5) {
  Manipulator robot = loadUrdf(TAXELSIM_SOURCE_DIR "/scenes/robots/lwr_palm.urdf",
                               {.base_link = "", .sensors = {{"palm", {{0, -0.011, 0.045}, axisAngle({1, 0, 0}, std::numbers::pi / 2)}}}});
  robot.joints[1].initial_position = 0.5;
  robot.joints[3].initial_position = bend;
  robot.joints[5].initial_position = 1;
  return robot;
}

// Four degrees of freedom for six components of the twist, two of them prismatic; a mimic joint follows the second one with an offset.
Manipulator gantry() {
  Manipulator robot;
  robot.name = "gantry";
  robot.joints = {{.name = "x", .type = JointType::kPrismatic, .lower = -0.002, .upper = 0.05, .max_velocity = 0.05},
                  {.name = "lift", .type = JointType::kPrismatic, .lower = -0.05, .upper = 0.05, .max_velocity = 0.05},
                  {.name = "yaw", .max_velocity = 2, .initial_position = 0.3},
                  {.name = "tilt", .lower = -0.1, .upper = 0.4, .max_velocity = 1, .initial_position = 0.2}};
  const Quaternion z_to_x = axisAngle({0, 1, 0}, std::numbers::pi / 2);
  robot.sensors = {{.link = "tip",
                    .chain = {{.X_PJ = {{0.1, 0, 0}, z_to_x}, .type = JointType::kPrismatic, .joint = 0},
                              {.X_PJ = {{0, 0.02, 0.1}, axisAngle({0, 1, 0}, -1.2)}, .type = JointType::kPrismatic, .joint = 1},
                              {.X_PJ = {{0, 0, 0.05}, axisAngle({1, 2, 3}, 0.4)}, .joint = 2},
                              {.X_PJ = {{0.03, 0, 0.1}, z_to_x}, .joint = 1, .multiplier = -4, .offset = 0.2},
                              {.X_PJ = {{0, 0.04, 0}, axisAngle({0, 0, 1}, 0.5)}, .joint = 3}},
                    .X_JS = {{0, 0.01, 0.02}, axisAngle({1, 0, 0.3}, 0.7)}}};
  robot.X_WB = {{0.2, 0.1, 0}, axisAngle({0, 0, 1}, 0.3)};
  return robot;
}

Scene sceneWith(const Manipulator& robot, std::vector<TactileServo> servos) {
  Scene scene = sceneOf(std::move(servos));
  scene.robot = robot;
  return scene;
}

std::vector<TactileServo> allServos() {
  return {limitedServo(), rollingServo(), rollingServo(ServoFeature::kCenterX), saturatedServo(), leavingServo()};
}

// All flags of RobotStatus that a data set of loops on the device has.
unsigned flagsOf(const Scene& scene) {
  const TestDirectory directory;
  generateWith(scene, directory.path(), 64, 1, SlicePlan::Loops::kDevice);
  const DatasetReader reader(directory.path());
  unsigned flags = 0;
  const std::uint64_t num_frames = scene.num_episodes * static_cast<std::uint64_t>(numFrames(scene));
  for (const double status : reader.readAsDouble("data/robot/status", 0, num_frames)) flags |= static_cast<unsigned>(status);
  return flags;
}

TEST(DeviceRobots, PanTiltInAnyBatch) {
  const Scene scene = sceneWith(panTilt({}), allServos());
  expectSameBytes(scene, {{1, 1}, {7, 2}, {64, 1}, {64, 3}});
  EXPECT_EQ(flagsOf(scene) & (kJointLimit | kLost), 0u);
}

TEST(DeviceRobots, ArmInAnyBatch) {
  const Scene scene = sceneWith(arm(), allServos());
  expectSameBytes(scene, {{1, 1}, {7, 2}, {64, 1}, {64, 3}});
  EXPECT_EQ(flagsOf(scene) & (kJointLimit | kLost), 0u);
}

TEST(DeviceRobots, QuantizedAndDelayedDrives) {
  for (const int delay : {1, 3}) {
    PanTilt platform{.drive = {.position_step = 0.003, .delay = delay}};
    platform.position_limits = {-0.05, 0.0413};
    platform.max_velocity = 1;
    const Scene scene = sceneWith(panTilt(platform), allServos());
    expectSameBytes(scene, {{7, 2}});
    EXPECT_EQ(flagsOf(scene), unsigned{kJointLimit | kVelocityLimit});
  }
  Manipulator robot = arm();
  robot.drive = {.position_step = 1e-4, .delay = 2};
  expectSameBytes(sceneWith(robot, allServos()));
}

// A joint that the servo cannot move rests between two steps of its drive.
TEST(DeviceRobots, DrivesRoundHalfAwayFromZero) {
  constexpr double kStep = 0x1p-12;
  Manipulator robot = panTilt({.drive = {.position_step = kStep, .delay = 0}});
  robot.joints.push_back({.name = "slide", .type = JointType::kPrismatic, .lower = -0.1, .upper = 0.1, .initial_position = -2.5 * kStep});
  robot.sensors[0].chain.push_back({.X_PJ = {}, .type = JointType::kPrismatic, .joint = 2});
  const Scene scene = sceneWith(robot, {limitedServo()});
  expectSameBytes(scene);
}

// Damping varies with the smallest eigenvalue; selections of rows change which poses are singular.
TEST(DeviceRobots, NearSingularities) {
  for (const double bend : {0.0, -1e-3, -0.2}) {
    const Scene scene = sceneWith(arm(bend), allServos());
    expectSameBytes(scene);
    EXPECT_NE(flagsOf(scene) & kSingular, 0u) << bend;
  }
  Manipulator robot = arm(0);
  robot.selection = {true, true, true, false, false, true};
  robot.singular_threshold = 1;
  robot.max_damping = 0.3;
  const Scene scene = sceneWith(robot, allServos());
  expectSameBytes(scene);
  EXPECT_NE(flagsOf(scene) & kSingular, 0u);
}

// The wrist and the elbow start near their limits, one after another joint stops.
TEST(DeviceRobots, AtLimitsOfJoints) {
  Manipulator robot = arm();
  for (Joint& joint : robot.joints) {
    joint.lower = joint.initial_position - 0.004;
    joint.upper = joint.initial_position + 0.003;
    joint.max_velocity = 0.3;
  }
  const Scene scene = sceneWith(robot, allServos());
  expectSameBytes(scene);
  EXPECT_EQ(flagsOf(scene) & (kJointLimit | kVelocityLimit), unsigned{kJointLimit | kVelocityLimit});
}

TEST(DeviceRobots, PrismaticAndMimicJointsWithFewerJointsThanComponents) {
  Manipulator robot = gantry();
  expectSameBytes(sceneWith(robot, allServos()), {{7, 2}});
  robot.drive = {.position_step = 2e-4, .delay = 1};
  robot.selection = {true, false, true, true, false, false};
  const Scene scene = sceneWith(robot, allServos());
  expectSameBytes(scene);
  EXPECT_NE(flagsOf(scene) & kJointLimit, 0u);
}

TEST(DeviceRobots, DepthDrivenStartsAndLostContact) {
  Scene scene = sceneWith(arm(), {leavingServo(), limitedServo(), saturatedServo()});
  scene.randomization.load.reset();
  scene.randomization.depth = Range{0, 0.6e-3};
  scene.num_steps = 60;
  expectSameBytes(scene);
}

// A twist that is not finite stops the joints.
TEST(DeviceRobots, LostRobots) {
  TactileServo servo;
  servo[ServoFeature::kTotalForce] = {.selected = true, .reference = 30, .kp = 1e308};
  Manipulator robot = arm();
  robot.drive.delay = 1;
  Scene scene = sceneWith(robot, {servo});
  scene.record = {"features", "poses", "robot"};
  expectSameBytes(scene);
  EXPECT_NE(flagsOf(scene) & kLost, 0u);
}

// Two equal joints are singular, and a damping that rounds to 0 leaves no finite velocity.
TEST(DeviceRobots, LostWithoutDamping) {
  Manipulator robot;
  robot.name = "lift";
  const Joint lift{.name = "lift", .type = JointType::kPrismatic, .lower = -0.05, .upper = 0.05, .max_velocity = 0.1};
  robot.joints = {lift, lift};
  robot.joints[1].name = "second";
  const ChainJoint along_z{.X_PJ = {}, .type = JointType::kPrismatic};
  robot.sensors = {{.link = "tip", .chain = {along_z, along_z}}};
  robot.sensors[0].chain[1].joint = 1;
  robot.max_damping = 1e-200;
  const Scene scene = sceneWith(robot, {limitedServo()});
  expectSameBytes(scene);
  EXPECT_NE(flagsOf(scene) & kLost, 0u);
}

TEST(DeviceRobots, ControlRatesBelowTheRateOfTheSimulation) {
  Scene scene = sceneWith(arm(), {limitedServo(), rollingServo()});
  scene.control_rate = 20;
  expectSameBytes(scene);
}

TEST(DeviceRobots, ShippedScenes) {
  const std::filesystem::path paper = TAXELSIM_SOURCE_DIR "/scenes/experiments/paper";
  Scene platform = loadScene(paper / "pan_tilt_scene.yaml"), hand = loadScene(paper / "cartesian_hand_scene.yaml");
  std::erase_if(platform.controllers, [](const SceneController& controller) { return controller.name == "exact"; });
  std::erase_if(hand.objects, [](const SceneObject& object) { return object.motion.has_value(); });
  for (Scene* const scene : {&platform, &hand}) {
    scene->num_steps = 40;
    scene->num_episodes = 8;
    scene->episodes_per_shard = 4;
    expectSameBytes(*scene, {{8, 1}});
  }
}

// Joints come back only where the sink reads them.
TEST(DeviceRobots, ExchangeOnlyWhatTheSinkReads) {
  class NoSink : public EpisodeSink {
   public:
    std::optional<std::uint64_t> next(int) override { return next_ < 16 ? std::optional(next_++) : std::nullopt; }
    void begin(int, const EpisodeRecord&) override {}
    void frame(const FrameView&, const FrameContext& context) override {
      num_values = context.joint_positions.size() + context.joint_velocities.size();
    }
    void end(int) override {}
    std::size_t num_values = 0;

   private:
    std::uint64_t next_ = 0;
  };
  const Scene scene = sceneWith(arm(), {limitedServo()});
  const Model model(device(), modelOptionsOf(scene));
  std::uint64_t bytes[2];
  for (const bool joints : {false, true}) {
    SlicePlan plan(scene, kNoOutputs);
    plan.loops = SlicePlan::Loops::kDevice;
    plan.sink_reads = {.joints = joints};
    NoSink sink;
    Slice slice(model, plan, 16, sink);
    slice.submit();
    bytes[joints] = slice.collect().traffic.bytes_from_device;
    EXPECT_EQ(sink.num_values, joints ? 2u * 16 * 7 : 0u);
  }
  EXPECT_EQ(bytes[1] - bytes[0], 2 * 16 * 7 * sizeof(double));
}

TEST(DeviceRobots, RunWhereNothingNeedsTheHost) {
  const auto why = [](const std::function<void(Manipulator&)>& change) {
    Manipulator robot = gantry();
    change(robot);
    Scene scene = sceneWith(robot, {limitedServo()});
    return std::string(whyOnHost(SlicePlan(scene, kNoOutputs)));
  };
  EXPECT_EQ(why([](Manipulator&) {}), "");
  EXPECT_EQ(why([](Manipulator& robot) { robot.sensors.push_back(robot.sensors[0]); }), "the robot carries several sensors");
  EXPECT_EQ(why([](Manipulator& robot) { robot.sensors[0].chain.clear(); }), "no joint moves the sensor");
  EXPECT_EQ(why([](Manipulator& robot) { robot.joints[2].max_velocity = kInfinity; }), "a joint may turn too far");
  EXPECT_EQ(why([](Manipulator& robot) { robot.joints[2].initial_position = 1e7; }), "a joint may turn too far");
  EXPECT_EQ(why([](Manipulator& robot) { robot.sensors[0].chain[3].offset = -1e7; }), "a joint may turn too far");
  EXPECT_EQ(why([](Manipulator& robot) { robot.sensors[0].chain[3].multiplier = 1e9; }), "a joint may turn too far");
  // Limits bound what the velocity does not; prismatic joints take no sine.
  EXPECT_EQ(why([](Manipulator& robot) { robot.joints[3].max_velocity = kInfinity; }), "");
  EXPECT_EQ(why([](Manipulator& robot) { robot.joints[0].max_velocity = robot.joints[0].upper = kInfinity; }), "");
}

}  // namespace
}  // namespace taxelsim
