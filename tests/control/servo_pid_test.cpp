// PID loops of the tactile servo, in closed loop with an ideal angle.
#include "control/twist.h"
#include "servo_fixtures.h"
#include "support/test.h"

namespace taxelsim {
namespace {

// Closed loop with a line that is fixed in the world: the angle error (rad) at each tick.
std::vector<double> angleErrors(const TactileServo& servo, double start, int num_steps) {
  TactileServoController controller(servo, gridSensor(), 1);
  const double reference = servo[kAngle].reference.value_or(0), line_W = reference + start;
  Pose X_WS;
  std::vector<double> errors;
  for (int n = 0; n < num_steps; ++n) {
    const double yaw = 2 * std::atan2(X_WS.rotation[3], X_WS.rotation[0]);
    errors.push_back(line_W - yaw - reference);
    X_WS = integrate(X_WS, commandOne(controller, {.angle = static_cast<float>(line_W - yaw)}), kPeriod);
  }
  return errors;
}

// P control of an integrator: e_n = (1 - K Ts)^n e_0.
TEST(ServoPid, ProportionalErrorDecaysGeometrically) {
  constexpr double kGain = 0.78, kStart = 0.6;
  const std::vector<double> errors = angleErrors(servoOf({{kAngle, {.reference = 0.2, .kp = kGain}}}), kStart, 500);
  for (std::size_t n = 0; n < errors.size(); ++n) {
    ASSERT_NEAR(errors[n], kStart * std::pow(1 - kGain * kPeriod, n), (static_cast<double>(n) + 1) * kFloat) << "step " << n;
  }
}

// PI control of an integrator has the characteristic polynomial s^2 + kp s + ki. With rho < 1 the ratio of its roots, the step response
// overshoots by rho^((1 + rho) / (1 - rho)) of the initial error.
TEST(ServoPid, IntegralOvershootMatchesTheClosedForm) {
  for (const double ratio : {0.1, 0.3}) {
    constexpr double kFast = 2;  // 1/s, magnitude of the larger root
    const double slow = ratio * kFast, start = 0.5;
    const TactileServo servo = servoOf({{kAngle, {.kp = kFast + slow, .ki = kFast * slow}}});
    const std::vector<double> errors = angleErrors(servo, start, 2000);
    const double expected = std::pow(ratio, (1 + ratio) / (1 - ratio));
    // Discretization moves the roots by about one period times the root squared.
    const double tolerance = 2 * kFast * kPeriod * expected;
    EXPECT_NEAR(-*std::min_element(errors.begin(), errors.end()) / start, expected, tolerance) << ratio;
  }
}

// e_(n+1) = e_n - Ts (kp e_n + kd (e_n - e_(n-1)) / Ts), without the derivative in the first tick.
TEST(ServoPid, DerivativeMatchesItsRecursion) {
  constexpr double kGain = 2, kRateGain = 0.4, kStart = 0.5;
  const std::vector<double> errors = angleErrors(servoOf({{kAngle, {.kp = kGain, .kd = kRateGain}}}), kStart, 300);
  double before = kStart, error = kStart;
  for (std::size_t n = 0; n < errors.size(); ++n) {
    ASSERT_NEAR(errors[n], error, 300 * kFloat) << "step " << n;
    const double rate = n == 0 ? 0 : (error - before) / kPeriod;
    before = error;
    error -= kPeriod * (kGain * error + kRateGain * rate);
  }
}

TEST(ServoPid, ClampsErrorIntegralAndDerivative) {
  const auto first = [](const FeatureLoop& loop) { return commandOne(servoOf({{kAngle, loop}}), {.angle = 1.0f}).w[2]; };
  EXPECT_NEAR(first({.kp = 2, .error_limit = 0.1}), 0.2, 0.2 * kFloat);
  EXPECT_NEAR(first({.kp = 0, .ki = 100, .integral_limit = 0.001}), 0.1, 0.1 * kFloat);
  TactileServoController controller(servoOf({{kAngle, {.kd = 0.5, .derivative_limit = 0.3}}}), gridSensor(), 1);
  EXPECT_EQ(commandOne(controller, {.angle = 0.5f}).w[2], 0) << "the derivative is undefined in the first tick";
  EXPECT_NEAR(commandOne(controller, {.angle = 1.0f}).w[2], 0.5 * 0.3, kFloat);
}

// Anti-windup: a saturated velocity does not increase the overshoot.
TEST(ServoPid, IntegralDoesNotWindUpWhileSaturated) {
  constexpr double kStart = 1.2;
  TactileServo servo = servoOf({{kAngle, {.kp = 2.2, .ki = 0.4}}});
  const auto overshoot = [](const std::vector<double>& errors) { return -*std::min_element(errors.begin(), errors.end()); };
  const double unsaturated = overshoot(angleErrors(servo, kStart, 3000));
  servo.max_angular_velocity = 0.2;
  EXPECT_LE(overshoot(angleErrors(servo, kStart, 3000)), unsaturated);
}

}  // namespace
}  // namespace taxelsim
