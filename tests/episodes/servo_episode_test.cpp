// Closed-loop servo episodes: the sensor aligns with a lying cylinder and regulates the contact force.
#include "episodes/example_scene.h"
#include "support/test.h"
#include "taxelsim/generate.h"

namespace taxelsim {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kTargetAngle = std::numbers::pi / 2;

// 5 s at the default gains: the paper's convergence time for the angle (2 % of 60 degrees is 1.2), and e^{-5} or less for the force. The
// limits allow for the bias of the principal axis of a truncated line, and of forces from counts.
constexpr int kNumSteps = 500;
constexpr double kAngleLimit = 5 * kDegree;
constexpr double kForceLimit = 0.1;

Scene servoScene() {
  Scene scene = exampleScene();
  scene.objects.resize(1);
  scene.num_steps = kNumSteps;
  scene.control_rate = scene.simulation_rate;
  scene.num_episodes = 12;
  scene.episodes_per_shard = 12;
  scene.randomization = {};
  scene.randomization.x = {-0.003, 0.003};
  scene.randomization.y = {-0.004, 0.004};
  // At zero yaw the bar's axis is along y, the target.
  scene.randomization.yaw = {-60 * kDegree, 60 * kDegree};
  scene.randomization.load = Range{2, 5};
  scene.controllers[0].servo = edgeServo();
  scene.controllers[0].servo[ServoFeature::kEdgeAngle].reference = kTargetAngle;
  return scene;
}

double lineError(double angle, double target) {
  return std::abs(std::remainder(angle - target, std::numbers::pi));
}

void expectConverges(const Scene& scene) {
  const TestDirectory directory;
  ASSERT_TRUE(generate(Device::open(), scene, directory.path(), {.batch_size = 12, .on_progress = {}, .stop = nullptr}).complete);
  const DatasetReader reader(directory.path());
  const std::vector<double> angle = reader.readAsDouble("data/edge_angle", 0, reader.numFrames());
  const std::vector<double> force = reader.readAsDouble("data/total_force", 0, reader.numFrames());
  const std::vector<double> load = reader.readAsDouble("meta/load", 0, scene.num_episodes);
  double worst_start = 0;
  for (std::uint64_t episode = 0; episode < scene.num_episodes; ++episode) {
    const std::uint64_t first = episode * kNumSteps, last = first + kNumSteps - 1;
    worst_start = std::max(worst_start, lineError(angle[first], kTargetAngle));
    EXPECT_LT(lineError(angle[last], kTargetAngle), kAngleLimit) << "episode " << episode;
    const double target = scene.randomization.load ? load[episode] : force[first];
    EXPECT_NEAR(force[last], target, kForceLimit * target) << "episode " << episode;
  }
  EXPECT_GT(worst_start, 30 * kDegree);  // the initial error is significant
}

TEST(ServoEpisode, ConvergesToTargetAngleAndForce) {
  expectConverges(servoScene());
}

TEST(ServoEpisode, ConvergesWithAReducedFrameRate) {
  Scene scene = servoScene();
  scene.sensor.frame_rate = 31;  // with a zero-order hold, stable for gain * frame period < 1
  expectConverges(scene);
}

TEST(ServoEpisode, HoldsTheForceOfADepthDrivenStart) {
  Scene scene = servoScene();
  scene.randomization.load.reset();
  scene.randomization.depth = Range{0.3e-3, 0.6e-3};
  expectConverges(scene);
}

// As with a free-flying sensor, on a seven-joint arm.
TEST(ServoEpisode, ConvergesOnAnArm) {
  Scene scene = servoScene();
  Manipulator arm = loadUrdf(TAXELSIM_SOURCE_DIR "/scenes/robots/lwr_palm.urdf", {.base_link = "", .sensors = {{"palm", {}}}});
  // A bent posture, away from kinematic singularities.
  for (const auto& [joint, position] : {std::pair{1, 30 * kDegree}, {3, -90 * kDegree}, {5, 60 * kDegree}}) {
    arm.joints[static_cast<std::size_t>(joint)].initial_position = position;
  }
  scene.robot = arm;
  expectConverges(scene);
}

// A sensor with gain 0.5 presses twice as hard: the load applies in the first frame only, afterwards the servo regulates the measured
// force.
TEST(ServoEpisode, RegulatesTheMeasuredForce) {
  Scene scene = servoScene();
  scene.randomization.gain = {0.5, 0.5};
  const TestDirectory directory;
  ASSERT_TRUE(generate(Device::open(), scene, directory.path(), {.batch_size = 12, .on_progress = {}, .stop = nullptr}).complete);
  const DatasetReader reader(directory.path());
  const std::vector<double> force = reader.readAsDouble("data/ground_truth/total_force", 0, reader.numFrames());
  const std::vector<double> load = reader.readAsDouble("meta/load", 0, scene.num_episodes);
  for (std::uint64_t episode = 0; episode < scene.num_episodes; ++episode) {
    EXPECT_NEAR(force[episode * kNumSteps], load[episode], kForceLimit * load[episode]) << "episode " << episode;
    // Besides kForceLimit: the trigger of each taxel is subtracted after the gain and added back before it.
    const double trigger = scene.sensor.readout.trigger * numTaxels(scene.sensor);
    EXPECT_NEAR(force[(episode + 1) * kNumSteps - 1], 2 * load[episode], 2 * kForceLimit * load[episode] + trigger)
        << "episode " << episode;
  }
}

// With the measured tactile Jacobian the errors are decoupled and decay as (1 - kp Ts)^n, independent of the contact stiffness.
TEST(ServoEpisode, MeasuredJacobianDecouplesForceAndCentre) {
  Scene scene = servoScene();
  scene.num_steps = 40;
  scene.sensor.readout.trigger = 0;
  scene.sensor.readout.noise = 0;
  scene.sensor.readout.curve = {10000};  // 0.1 mN per count, over about 20 taxels
  scene.sensor.readout.adc_bits = 16;
  scene.sensor.readout.saturation = 65535;
  scene.randomization.x = {-0.002, 0.002};
  scene.randomization.y = {-0.004, 0.004};
  scene.randomization.load = Range{2, 5};
  scene.objects = {{.object = Object("ball", Sphere{.radius = 0.012})}};
  constexpr double kGain = 5, kForce = 3.5;
  TactileServo servo{.max_angular_velocity = 10, .max_linear_velocity = 1};
  servo[ServoFeature::kTotalForce] = {.selected = true, .reference = kForce, .kp = kGain};
  servo[ServoFeature::kCenterX] = {.selected = true, .kp = kGain};
  servo[ServoFeature::kCenterY] = {.selected = true, .kp = kGain};
  servo.jacobian = TactileJacobianSource::kMeasured;
  scene.controllers[0].servo = servo;
  const TestDirectory directory;
  ASSERT_TRUE(generate(Device::open(), scene, directory.path(), {.batch_size = 12, .on_progress = {}, .stop = nullptr}).complete);
  const DatasetReader reader(directory.path());
  const std::vector<double> force = reader.readAsDouble("data/total_force", 0, reader.numFrames());
  const std::vector<double> center = reader.readAsDouble("data/center_of_pressure", 0, reader.numFrames());
  // Relative to the initial error. Linearisation: force is nonlinear in depth, up to 1.25 % per step; Jacobian at 4 x 4 samples: 1 % of
  // force, 4 % of the centre.
  constexpr double kForceTolerance = 0.03, kCenterTolerance = 0.05;
  // N: the force of a ball that slides over the samples, 4 to 5 per contact radius, varies by up to 1 %.
  constexpr double kRipple = 0.01 * kForce;
  for (std::uint64_t episode = 0; episode < scene.num_episodes; ++episode) {
    const std::uint64_t first = episode * 40;
    for (std::uint64_t n = 0; n < 40; ++n) {
      const double decay = std::pow(1 - kGain / scene.simulation_rate, n);
      EXPECT_NEAR(force[first + n] - kForce, decay * (force[first] - kForce), kForceTolerance * std::abs(force[first] - kForce) + kRipple)
          << "episode " << episode << ", frame " << n;
      for (const std::size_t axis : {0, 1}) {
        EXPECT_NEAR(center[3 * (first + n) + axis], decay * center[3 * first + axis], kCenterTolerance * 0.004)
            << "episode " << episode << ", frame " << n;
      }
    }
  }
}

}  // namespace
}  // namespace taxelsim
