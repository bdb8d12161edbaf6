// Servos whose loop the device closes give the same bytes as the host's: data sets, verdicts, traces of bits.
#include "control/robots.h"
#include "device_servo_cases.h"
#include "episodes/batch.h"
#include "episodes/task_evaluator.h"
#include "support/test.h"
#include "taxelsim/dataset.h"

namespace taxelsim {
namespace {

TactileServo servoOf(EdgeAngleSource source, ServoContact contact) {
  TactileServo servo = limitedServo();
  servo.edge_angle_source = source;
  servo.contact = contact;
  return servo;
}

TactileServo tiltServo(double min_confidence) {
  TactileServo servo = edgeServo();
  servo.min_confidence = min_confidence;
  servo[ServoFeature::kTiltX] = loopOf(2);
  servo[ServoFeature::kTiltY] = loopOf(2);
  return servo;
}

TEST(DeviceServos, WholeContactInAnyBatch) {
  const Scene scene = sceneOf({limitedServo(), rollingServo(), rollingServo(ServoFeature::kCenterX), saturatedServo(), leavingServo()});
  expectSameBytes(scene, {{1, 1}, {7, 2}, {64, 1}, {64, 3}});
}

TEST(DeviceServos, ContactFeatures) {
  Scene scene = sceneOf(
      {servoOf(EdgeAngleSource::kWindow, ServoContact::kWhole), servoOf(EdgeAngleSource::kRidge, ServoContact::kWhole), limitedServo()});
  expectSameBytes(scene);
  scene.record.emplace_back("contact_features");
  scene.max_regions = 2;
  expectSameBytes(scene);
}

// A ring crosses the array twice.
TEST(DeviceServos, LargestRegion) {
  Scene scene = sceneOf({servoOf(EdgeAngleSource::kPrincipalAxis, ServoContact::kLargestRegion)});
  scene.objects = {{Object("ring", Torus{.major_radius = 0.015, .minor_radius = 0.003}), 1, {1, 0, 0, 0}}};
  expectSameBytes(scene);
}

TEST(DeviceServos, Tilt) {
  Scene scene = sceneOf({tiltServo(0.2), tiltServo(0.8), tiltServo(0.95)});
  scene.objects = {{Object("plate", Box{.size = {0.02, 0.03, 0.02}}), 1, {1, 0, 0, 0}}};
  scene.randomization.tilt = {0, 0.02};
  expectSameBytes(scene);
}

// Contact is lost and found in episodes that start at a depth.
TEST(DeviceServos, DepthDrivenStartsAndLostContact) {
  Scene scene = sceneOf({leavingServo(), limitedServo(), saturatedServo()});
  scene.randomization.load.reset();
  scene.randomization.depth = Range{0, 0.6e-3};
  scene.num_steps = 60;
  scene.task = Task{.hold = 0.1};
  (*scene.task)[TaskMeasure::kTotalForce] = TaskCriterion{.tolerance = 0.5};
  expectSameBytes(scene);
}

// The stiffness of a contact of one taxel is that of its pitch area, not of the contact area, which is less by the rounding to float32.
TEST(DeviceServos, ContactsOfOneTaxel) {
  Scene scene = sceneOf({limitedServo(), rollingServo()});
  scene.sensor.patches[0].pitch = {3.2e-3, 3.2e-3};
  scene.objects = {{Object("pin", Sphere{.radius = 1e-3}), 1, {1, 0, 0, 0}}};
  scene.randomization.load = Range{0.05, 0.12};
  scene.sensor.readout.noise = 0;
  expectSameBytes(scene);
}

// Patches of different pitch, one of which is tilted: the load search runs over tiles, and the force of the first frame is no load.
TEST(DeviceServos, SeveralPatches) {
  Scene scene = sceneOf({limitedServo(), servoOf(EdgeAngleSource::kWindow, ServoContact::kLargestRegion)});
  scene.sensor.patches.push_back({.name = "side",
                                  .num_rows = 6,
                                  .num_cols = 5,
                                  .pitch = {2e-3, 3e-3},
                                  .X_SP = {{0, 0.033, -0.001}, axisAngle({1, 0, 0}, -10 * kDegree)}});
  scene.randomization.y = {0.01, 0.02};
  expectSameBytes(scene);
}

// A force out of reach drives the sensor through the object, which then presses on nothing.
TEST(DeviceServos, ObjectsBehindTheSkin) {
  TactileServo servo;
  servo[ServoFeature::kTotalForce] = {.selected = true, .reference = 1000, .kp = 50};
  servo.max_linear_velocity = 1;
  const Scene scene = sceneOf({servo});
  expectSameBytes(scene);
}

// A gain that overflows commands a twist that is not finite: the robot is lost and does not move. Bits of NaN in actions are the driver's.
TEST(DeviceServos, LostRobots) {
  TactileServo servo;
  servo[ServoFeature::kTotalForce] = {.selected = true, .reference = 30, .kp = 1e308};
  Scene scene = sceneOf({servo});
  scene.record = {"features", "poses", "robot"};
  expectSameBytes(scene);
  const TestDirectory directory;
  generateWith(scene, directory.path(), 64, 1, Loops::kDevice);
  const std::vector<double> status = DatasetReader(directory.path()).readAsDouble("data/robot/status", 0, 7);
  EXPECT_EQ(status[0], 0);
  EXPECT_EQ(status[1], kLost);
}

TEST(DeviceServos, RatesOfControlAndSensor) {
  for (const double control_rate : {100.0, 20.0}) {
    Scene scene = sceneOf({limitedServo(), rollingServo()});
    scene.control_rate = control_rate;
    scene.sensor.frame_rate = 31;
    scene.randomization.exploration_velocity = Range{0, 0.01};
    expectSameBytes(scene);
  }
}

TEST(DeviceServos, ShippedScene) {
  Scene scene = loadScene(TAXELSIM_SOURCE_DIR "/scenes/edge_servo.yaml");
  scene.num_steps = 25;
  scene.num_episodes = 40;
  scene.episodes_per_shard = 20;
  expectSameBytes(scene, {{40, 2}});
}

// A device that closes loops neither sends nor receives poses for them.
TEST(DeviceServos, ExchangeOnlyWhatTheSinkReads) {
  class NoSink : public EpisodeSink {
   public:
    std::optional<std::uint64_t> next(int) override { return next_ < 16 ? std::optional(next_++) : std::nullopt; }
    void begin(int, const EpisodeRecord&) override {}
    void frame(const FrameView&, const FrameContext& context) override {
      num_poses += context.X_SO.size() + context.X_WS.size();
      num_actions += context.actions.size();
    }
    void end(int) override {}
    std::size_t num_poses = 0, num_actions = 0;

   private:
    std::uint64_t next_ = 0;
  };
  const Scene scene = sceneOf({limitedServo()});
  const Model model(device(), modelOptionsOf(scene));
  const auto trafficOf = [&](Loops loops, const LoopOutputs& reads) {
    SlicePlan plan(scene, kNoOutputs);
    plan.loops = loops;
    plan.sink_reads = reads;
    NoSink sink;
    Slice slice(model, plan, 16, sink);
    DeviceTraffic traffic;
    for (int frame = 0; frame < 5; ++frame) {
      slice.submit();
      traffic = slice.collect().traffic;
    }
    if (loops == Loops::kDevice) {
      EXPECT_EQ(sink.num_poses > 0, reads.object_poses);
      EXPECT_EQ(sink.num_actions > 0, reads.actions);
    }
    return traffic;
  };
  constexpr LoopOutputs kNothing{.object_poses = false, .sensor_poses = false, .actions = false, .robot_status = false, .joints = false};
  const DeviceTraffic host = trafficOf(Loops::kHost, {}), least = trafficOf(Loops::kDevice, kNothing), all = trafficOf(Loops::kDevice, {});
  EXPECT_EQ(host.bytes_to_device - least.bytes_to_device, 16 * 64u);  // a pose record per instance
  EXPECT_EQ(least.bytes_from_device, host.bytes_from_device);
  EXPECT_EQ(all.bytes_from_device - least.bytes_from_device, 16 * (7 + 7 + 6) * sizeof(double) + 16 * sizeof(std::uint32_t));
  LoopOutputs no_image = kNothing;
  no_image.tactile_image = false;
  const auto num_taxels = static_cast<std::size_t>(numTaxels(scene.sensor));
  EXPECT_EQ(least.bytes_from_device - trafficOf(Loops::kDevice, no_image).bytes_from_device, 16 * num_taxels * sizeof(std::uint32_t));
}

std::vector<Verdict> verdictsOf(const Model& model, const Scene& scene, Loops loops) {
  SlicePlan plan(scene, kNoOutputs, 0);
  plan.loops = loops;
  plan.sink_reads = TaskJudge::kReads;
  plan.host_threads = loops == Loops::kHost ? 1 : 3;  // that share the judging
  std::vector<Verdict> verdicts(scene.num_episodes);
  std::uint64_t next = 0;
  TaskEvaluator evaluator(plan, 0, next, verdicts, 8);
  std::vector<std::unique_ptr<Slice>> slices;
  slices.push_back(std::make_unique<Slice>(model, plan, 8, evaluator));
  runEpisodes(model.device(), slices, nullptr, [](const Slice::Stats&) {});
  return verdicts;
}

TEST(DeviceServos, VerdictsAreThoseOfTheHost) {
  Scene scene = sceneOf({limitedServo(), saturatedServo()});
  scene.objects.resize(1);
  scene.objects[0].edge = Vector3{0, 0, 1};
  scene.num_steps = 80;
  scene.task = Task{.hold = 0.2};
  (*scene.task)[TaskMeasure::kEdgeAngle] = TaskCriterion{.tolerance = 20 * kDegree, .reference = std::numbers::pi / 2};
  (*scene.task)[TaskMeasure::kTotalForce] = TaskCriterion{.tolerance = 0.5};
  const Model model(device(), modelOptionsOf(scene));
  const std::vector<Verdict> host = verdictsOf(model, scene, Loops::kHost), on_device = verdictsOf(model, scene, Loops::kDevice);
  int num_successes = 0;
  for (std::size_t e = 0; e < host.size(); ++e) {
    num_successes += host[e].success ? 1 : 0;
    EXPECT_EQ(host[e].success, on_device[e].success) << e;
    EXPECT_EQ(std::memcmp(&host[e].steady_error, &on_device[e].steady_error, sizeof host[e].steady_error), 0) << e;
    EXPECT_EQ(std::memcmp(&host[e].start_error, &on_device[e].start_error, sizeof host[e].start_error), 0) << e;
    EXPECT_EQ(std::memcmp(&host[e].settling_time, &on_device[e].settling_time, sizeof(float)), 0) << e;
    EXPECT_EQ(host[e].travel, on_device[e].travel) << e;
    EXPECT_EQ(host[e].peak_force, on_device[e].peak_force) << e;
    EXPECT_EQ(host[e].robot, on_device[e].robot) << e;
  }
  EXPECT_GT(num_successes, 0);
}

TEST(DeviceServos, RunWhereNothingNeedsTheHost) {
  const auto why = [](const std::function<void(Scene&)>& change) {
    Scene scene = sceneOf({limitedServo(), rollingServo()});
    change(scene);
    return whyOnHost(SlicePlan(scene, kNoOutputs));
  };
  EXPECT_EQ(why([](Scene&) {}), "");
  EXPECT_EQ(why([](Scene& scene) { scene.kind = Scene::Kind::kContacts; }), "the scene's servos do not command");
  EXPECT_EQ(why([](Scene& scene) { scene.contact_points.emplace(); }), "contact points are recorded");
  EXPECT_EQ(why([](Scene& scene) { scene.objects.clear(); }), "no objects");
  EXPECT_EQ(why([](Scene& scene) { scene.objects[1].motion = Sinusoid{}; }), "an object moves");
  EXPECT_EQ(why([](Scene& scene) { scene.sensor.skin.friction = {.tangential_stiffness = 1e8, .friction_coefficient = 0.5}; }),
            "the skin has friction");
  EXPECT_EQ(why([](Scene& scene) { std::get<Winkler>(scene.sensor.skin.law).normal_exponent = 1.5; }),
            "the skin's pressure is not proportional to depth");
  EXPECT_EQ(why([](Scene& scene) { scene.randomization.linear_action_noise = {0, 1e-3}; }), "actions have noise");
  EXPECT_EQ(why([](Scene& scene) { scene.randomization.angular_action_noise = {0.1, 0.1}; }), "actions have noise");
  EXPECT_EQ(why([](Scene& scene) { scene.randomization.mounting_yaw = Range{0, 0.1}; }), "the mounting varies");
  const auto whyWith = [&](const std::function<void(TactileServo&)>& change) {
    return why([&](Scene& scene) { change(scene.controllers[1].servo); });
  };
  EXPECT_EQ(whyWith([](TactileServo& servo) { servo.jacobian = TactileJacobianSource::kMeasured; }),
            "a servo inverts the measured Jacobian");
  EXPECT_EQ(whyWith([](TactileServo& servo) { servo.edge_angle_source = EdgeAngleSource::kExact; }), "a servo reads the exact edge angle");
  EXPECT_EQ(whyWith([](TactileServo& servo) { servo[ServoFeature::kEdgeAngle].reference = 2; }), "a reference angle is too large");
  EXPECT_EQ(whyWith([](TactileServo& servo) { servo.max_angular_velocity = 1e9; }), "a servo may rotate too far in a step");
}

// A servo that no episode has does not matter.
TEST(DeviceServos, RunWhereTheOnlyServoAllowsIt) {
  Scene scene = sceneOf({limitedServo(), rollingServo()});
  scene.controllers[1].servo.jacobian = TactileJacobianSource::kMeasured;
  EXPECT_EQ(whyOnHost(SlicePlan(scene, kNoOutputs, 0)), "");
  EXPECT_NE(whyOnHost(SlicePlan(scene, kNoOutputs, 1)), "");
}

TEST(DeviceServos, RunWhereThePlanSays) {
  const Scene scene = sceneOf({limitedServo()});
  const Model model(device(), modelOptionsOf(scene));
  SlicePlan plan(scene, kNoOutputs);
  EXPECT_EQ(plan.deviceLoops(model).has_value(), ServoLoop::isFaster(model));
  plan.loops = Loops::kHost;
  EXPECT_FALSE(plan.deviceLoops(model));
  plan.loops = Loops::kDevice;
  EXPECT_EQ(plan.deviceLoops(model).has_value(), ServoLoop::isSupported(model));
  EXPECT_TRUE(ServoLoop::isSupported(model));
}

}  // namespace
}  // namespace taxelsim
