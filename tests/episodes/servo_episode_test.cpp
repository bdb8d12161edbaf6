// The servo on the simulated sensor, from start to end: a lying cylinder is turned to the target angle and pressed to the target force.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "episodes/example_scene.h"
#include "taxelsim/generate.h"

namespace taxelsim {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kTargetAngle = std::numbers::pi / 2;

// 5 s at the default gains: the paper's convergence time for the angle (2 % of 60 degrees is 1.2), and e^{-5} or better for the force. What
// is left is bias: of the principal axis where the line leaves the array, and of counts that are turned back into newtons.
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
  scene.randomisation = {};
  scene.randomisation.x = {-0.003, 0.003};
  scene.randomisation.y = {-0.004, 0.004};
  // The bar's axis lies along y at yaw 0, which is the target.
  scene.randomisation.yaw = {-60 * kDegree, 60 * kDegree};
  scene.randomisation.load = Range{2, 5};
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
    const double target = scene.randomisation.load ? load[episode] : force[first];
    EXPECT_NEAR(force[last], target, kForceLimit * target) << "episode " << episode;
  }
  EXPECT_GT(worst_start, 30 * kDegree);  // else there was nothing to do
}

TEST(ServoEpisode, ConvergesToAngleAndForce) {
  expectConverges(servoScene());
}

TEST(ServoEpisode, ConvergesWithTheSensorsOwnFrameRate) {
  Scene scene = servoScene();
  scene.sensor.frame_rate = 31;  // held frames are stable as long as gain times frame period stays below 1
  expectConverges(scene);
}

TEST(ServoEpisode, HoldsTheForceOfADepthDrivenStart) {
  Scene scene = servoScene();
  scene.randomisation.load.reset();
  scene.randomisation.depth = Range{0.3e-3, 0.6e-3};
  expectConverges(scene);
}

// Seven joints carry the sensor where it would have flown.
TEST(ServoEpisode, ConvergesOnAnArm) {
  Scene scene = servoScene();
  Manipulator arm = loadUrdf(TAXELSIM_SOURCE_DIR "/scenes/robots/lwr_palm.urdf", {.base_link = "", .sensors = {{"palm", {}}}});
  // Bent, away from singular poses.
  for (const auto& [joint, position] : {std::pair{1, 30 * kDegree}, {3, -90 * kDegree}, {5, 60 * kDegree}}) {
    arm.joints[static_cast<std::size_t>(joint)].initial_position = position;
  }
  scene.robot = arm;
  expectConverges(scene);
}

// A sensor that reads half of what it feels presses twice as hard: after its first frame the object is no longer carried by the load, but
// by where the sensor has gone.
TEST(ServoEpisode, PressesUntilItReadsTheForce) {
  Scene scene = servoScene();
  scene.randomisation.gain = {0.5, 0.5};
  const TestDirectory directory;
  ASSERT_TRUE(generate(Device::open(), scene, directory.path(), {.batch_size = 12, .on_progress = {}, .stop = nullptr}).complete);
  const DatasetReader reader(directory.path());
  const std::vector<double> force = reader.readAsDouble("data/ground_truth/total_force", 0, reader.numFrames());
  const std::vector<double> load = reader.readAsDouble("meta/load", 0, scene.num_episodes);
  for (std::uint64_t episode = 0; episode < scene.num_episodes; ++episode) {
    EXPECT_NEAR(force[episode * kNumSteps], load[episode], kForceLimit * load[episode]) << "episode " << episode;
    // On top of the servo's own limit: every taxel's trigger is taken off after the gain and given back before it.
    const double trigger = scene.sensor.readout.trigger * numTaxels(scene.sensor);
    EXPECT_NEAR(force[(episode + 1) * kNumSteps - 1], 2 * load[episode], 2 * kForceLimit * load[episode] + trigger)
        << "episode " << episode;
  }
}

// With the measured tactile Jacobian every feature falls as its own sampled law, (1 - kp Ts)^n, whatever the contact's stiffness.
TEST(ServoEpisode, TheMeasuredJacobianMakesForceAndCentreFollowTheirLaw) {
  Scene scene = servoScene();
  scene.num_steps = 40;
  scene.sensor.readout.trigger = 0;
  scene.sensor.readout.noise = 0;
  scene.sensor.readout.curve = {10000};  // 0.1 mN a count, over some 20 taxels
  scene.sensor.readout.adc_bits = 16;
  scene.sensor.readout.saturation = 65535;
  scene.randomisation.x = {-0.002, 0.002};
  scene.randomisation.y = {-0.004, 0.004};
  scene.randomisation.load = Range{2, 5};
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
  // Force is curved in depth: the derivative of a step of 5 % of at most 1.5 N in 3 is off by at most 1.25 % of the step, and the
  // Jacobian at 4 x 4 samples by its own 1 % of force and 4 % of centre.
  constexpr double kForceLeft = 0.03, kCenterLeft = 0.05;
  // A ball that slides over samples, four to five to its contact's radius, changes its force by up to 1 %.
  constexpr double kRipple = 0.01 * kForce;
  for (std::uint64_t episode = 0; episode < scene.num_episodes; ++episode) {
    const std::uint64_t first = episode * 40;
    for (std::uint64_t n = 0; n < 40; ++n) {
      const double left = std::pow(1 - kGain / scene.simulation_rate, n);
      EXPECT_NEAR(force[first + n] - kForce, left * (force[first] - kForce), kForceLeft * std::abs(force[first] - kForce) + kRipple)
          << "episode " << episode << ", frame " << n;
      for (const std::size_t axis : {0, 1}) {
        EXPECT_NEAR(center[3 * (first + n) + axis], left * center[3 * first + axis], kCenterLeft * 0.004)
            << "episode " << episode << ", frame " << n;
      }
    }
  }
}

}  // namespace
}  // namespace taxelsim
