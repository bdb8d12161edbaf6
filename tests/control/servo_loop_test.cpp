// Closed-loop tests of the servo with a minimal plant: a cylinder on an elastic foundation, features as sums over taxels.
#include "control/twist.h"
#include "servo_fixtures.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr int kNumRows = 6, kNumCols = 14, kSamples = 8;
constexpr double kThickness = 2e-3;  // m
constexpr double kRadius = 8e-3;     // m
constexpr double kTrigger = 0.02;    // N

// Features of a long cylinder along z of O, for poses X_SO with its axis parallel to the skin.
Features featuresOf(const Pose& X_SO) {
  const Vector3 axis = rotate(X_SO.rotation, {0, 0, 1});
  double sum = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, area = 0;
  for (int i = 0; i < kNumRows; ++i) {
    for (int j = 0; j < kNumCols; ++j) {
      double force = 0;
      for (int a = 0; a < kSamples; ++a) {
        for (int b = 0; b < kSamples; ++b) {
          const double px = (i - (kNumRows - 1) / 2.0 + (a + 0.5) / kSamples - 0.5) * kPitch - X_SO.position[0];
          const double py = (j - (kNumCols - 1) / 2.0 + (b + 0.5) / kSamples - 0.5) * kPitch - X_SO.position[1];
          const double distance = px * axis[1] - py * axis[0];
          if (std::abs(distance) >= kRadius) continue;
          const double depth = std::sqrt(kRadius * kRadius - distance * distance) - X_SO.position[2];
          force += kStiffness * std::clamp(depth, 0.0, kThickness) * kPitch * kPitch / (kSamples * kSamples);
        }
      }
      if (force < kTrigger) continue;
      const double tx = (i - (kNumRows - 1) / 2.0) * kPitch, ty = (j - (kNumCols - 1) / 2.0) * kPitch;
      sum += force, x += force * tx, y += force * ty;
      xx += force * tx * tx, xy += force * tx * ty, yy += force * ty * ty;
      area += kPitch * kPitch;
    }
  }
  if (sum == 0) return {.confidence = 0, .force = 0, .area = 0};
  x /= sum, y /= sum;
  xx = xx / sum - x * x, xy = xy / sum - x * y, yy = yy / sum - y * y;
  return {.angle = static_cast<float>(0.5 * std::atan2(2 * xy, xx - yy)),
          .confidence = static_cast<float>(std::hypot(xx - yy, 2 * xy) / (xx + yy)),
          .force = static_cast<float>(sum),
          .area = static_cast<float>(area),
          .center = {static_cast<float>(x), static_cast<float>(y), 0}};
}

struct LoopEnd {
  Features features;
  Pose X_SO;
};

LoopEnd runLoop(const TactileServo& servo, double start_angle, double start_depth, float target_force, int num_steps) {
  Sensor sensor;
  sensor.patches.push_back({.name = "grid", .num_rows = kNumRows, .num_cols = kNumCols, .pitch = {kPitch, kPitch}, .X_SP = {}});
  sensor.skin = {.thickness = kThickness, .law = Winkler{.normal_contact_stiffness = kStiffness}};
  TactileServoController controller(servo, sensor, 1);
  // At yaw 0 the cylinder's axis is along y of S, so the angle of the line is yaw + pi/2.
  const Quaternion horizontal = axisAngle({1, 0, 0}, -std::numbers::pi / 2);
  const Pose X_WO{{0.003, -0.004, kRadius - start_depth}, axisAngle({0, 0, 1}, start_angle - std::numbers::pi / 2) * horizontal};
  Pose X_WS;
  LoopEnd end;
  for (int n = 0; n <= num_steps; ++n) {
    end.X_SO = inverse(X_WS) * X_WO;
    end.features = featuresOf(end.X_SO);
    const Features& f = end.features;
    Twist twist;
    ServoInput input = inputOf(f);
    input.start_force = {&target_force, 1};
    controller.command(input, kPeriod, {&twist, 1});
    X_WS = integrate(X_WS, twist, kPeriod);
  }
  return end;
}

TactileServo servoTo(double angle) {
  TactileServo servo = edgeServo();
  servo[ServoFeature::kEdgeAngle].reference = angle;
  return servo;
}

double lineAngle(const Pose& X_SO) {
  const Vector3 axis = rotate(X_SO.rotation, {0, 0, 1});
  return std::atan(axis[1] / axis[0]);
}

// After 5 s at 100 Hz the angle error is e^{-K t} = 2 % of the initial one at the paper's gain. The force loop has a rate of 2 / s times
// the fraction of the measured area that is loaded, at least one half: e^{-5} of the initial error. The rest is the bias of the principal
// axis where the line crosses the border of the array obliquely.
constexpr double kAngleLimit = 5 * std::numbers::pi / 180;  // rad
constexpr double kForceLimit = 0.1;                         // of the target
constexpr double kCenterLimit = 0.3e-3;                     // m: e^{-5} of the initial 3 mm is 0.02 mm
constexpr int kSteps = 500;

TEST(ServoLoop, ConvergesInAngleForceAndCenter) {
  for (const double target_degrees : {90.0, 60.0, 0.0}) {
    for (const double start_degrees : {target_degrees - 40, target_degrees + 55}) {
      const double target = target_degrees * std::numbers::pi / 180;
      const LoopEnd end = runLoop(servoTo(target), start_degrees * std::numbers::pi / 180, 0.3e-3, 4.0f, kSteps);
      EXPECT_NEAR(std::remainder(lineAngle(end.X_SO) - target, std::numbers::pi), 0, kAngleLimit)
          << "from " << start_degrees << " to " << target_degrees;
      EXPECT_NEAR(end.features.force, 4.0, 4.0 * kForceLimit);
      const double across = -end.features.center[0] * std::sin(target) + end.features.center[1] * std::cos(target);
      EXPECT_NEAR(across, 0, kCenterLimit);
    }
  }
}

TEST(ServoLoop, ApproachesTheObjectFromAbove) {
  const double target = std::numbers::pi / 2;
  const LoopEnd end = runLoop(servoTo(target), target, -1e-3, 4.0f, kSteps);
  EXPECT_NEAR(end.features.force, 4.0, 4.0 * kForceLimit);
}

TEST(ServoLoop, ExplorationFollowsTheEdge) {
  const double target = std::numbers::pi / 2;
  TactileServo servo = servoTo(target);
  servo.exploration_velocity = 0.01;
  const LoopEnd end = runLoop(servo, target - 0.3, 0.5e-3, 4.0f, kSteps);
  // The sensor moves by 5 cm along +y in 5 s, so the object's center moves from y = -4 mm to -54 mm in S.
  constexpr double kTolerance = 2e-3;  // m: deviation during the initial rotation by 0.3 rad, which is about a moving center
  EXPECT_NEAR(end.X_SO.position[1], -0.004 - 0.05, kTolerance);
  EXPECT_NEAR(end.features.force, 4.0, 4.0 * kForceLimit);
  EXPECT_NEAR(std::remainder(end.features.angle - target, std::numbers::pi), 0, kAngleLimit);
}

}  // namespace
}  // namespace taxelsim
