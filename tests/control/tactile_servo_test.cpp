#include "control/tactile_servo.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <vector>

#include "control/twist.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPitch = 3.4e-3;         // m
constexpr double kStiffness = 1.73e8;     // N/m^3
constexpr double kFloat = 4 * 0x1p-24;    // relative: features come as float32; a few roundings
constexpr double kSpeedRounding = 1e-12;  // relative: some double roundings

Sensor gridSensor(double exponent = 1) {
  Sensor sensor;
  sensor.patches.push_back({.name = "grid", .num_rows = 6, .num_cols = 14, .pitch = {kPitch, kPitch}, .X_SP = {}});
  sensor.skin = {.thickness = 2e-3, .law = Winkler{.normal_contact_stiffness = kStiffness, .normal_exponent = exponent}};
  return sensor;
}

struct Features {
  float angle = 0, confidence = 1, force = 2, area = 4e-5f, target = 2;
  std::array<float, 3> center{0, 0, 0};
};

constexpr double kPeriod = 0.01;  // s

ServoInput inputOf(const Features& f) {
  static constexpr std::uint8_t kDue = 1;
  return {.edge_angle = {&f.angle, 1},
          .edge_confidence = {&f.confidence, 1},
          .total_force = {&f.force, 1},
          .center_of_pressure = f.center,
          .contact_area = {&f.area, 1},
          .start_force = {&f.target, 1},
          .due = {&kDue, 1}};
}

ServoInput inputOf(std::span<const float> angle, std::span<const float> confidence, std::span<const float> force,
                   std::span<const float> center, std::span<const float> area, std::span<const float> target,
                   std::span<const std::uint8_t> due) {
  return {.edge_angle = angle,
          .edge_confidence = confidence,
          .total_force = force,
          .center_of_pressure = center,
          .contact_area = area,
          .start_force = target,
          .due = due};
}

Twist commandOne(TactileServoController& controller, const Features& f) {
  Twist twist;
  controller.command(inputOf(f), kPeriod, {&twist, 1});
  return twist;
}

Twist commandOne(const TactileServo& servo, const Features& f) {
  TactileServoController controller(servo, gridSensor(), 1);
  return commandOne(controller, f);
}

struct Setting {
  ServoFeature feature;
  FeatureLoop loop;
};

// A servo that holds these, and little stands in its way.
TactileServo servoOf(std::initializer_list<Setting> settings) {
  TactileServo servo{.max_angular_velocity = 10, .max_linear_velocity = 1};
  for (const Setting& setting : settings) {
    servo[setting.feature] = setting.loop;
    servo[setting.feature].selected = true;
  }
  return servo;
}

double speed(const Twist& t) {
  return std::sqrt(t.v[0] * t.v[0] + t.v[1] * t.v[1] + t.v[2] * t.v[2]);
}

constexpr ServoFeature kAngle = ServoFeature::kEdgeAngle, kForce = ServoFeature::kTotalForce, kAcross = ServoFeature::kCenterAcross,
                       kX = ServoFeature::kCenterX, kY = ServoFeature::kCenterY;

TEST(TactileServo, StandsStillAtTheReference) {
  EXPECT_EQ(commandOne(edgeServo(), Features{}), Twist{});
}

// A line fixed in the world, seen from the turning sensor, every error from the first tick on (rad).
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

// P on an integrator: e falls as (1 - K Ts)^n.
TEST(TactileServo, AngleErrorDecaysAsTheSampledLaw) {
  constexpr double kGain = 0.78, kStart = 0.6;
  const std::vector<double> errors = angleErrors(servoOf({{kAngle, {.reference = 0.2, .kp = kGain}}}), kStart, 500);
  for (std::size_t n = 0; n < errors.size(); ++n) {
    ASSERT_NEAR(errors[n], kStart * std::pow(1 - kGain * kPeriod, n), (static_cast<double>(n) + 1) * kFloat) << "step " << n;
  }
}

// PI on an integrator: the closed loop's roots are those of s^2 + kp s + ki, and with rho their ratio (< 1) the error overshoots by
// rho^((1 + rho) / (1 - rho)) of its start (the step response of such a loop with its one zero).
TEST(TactileServo, IntegralOvershootsAsItsRootsSay) {
  for (const double ratio : {0.1, 0.3}) {
    constexpr double kFast = 2;  // 1/s, the larger root
    const double slow = ratio * kFast, start = 0.5;
    const TactileServo servo = servoOf({{kAngle, {.kp = kFast + slow, .ki = kFast * slow}}});
    const std::vector<double> errors = angleErrors(servo, start, 2000);
    const double expected = std::pow(ratio, (1 + ratio) / (1 - ratio));
    // The sampled loop integrates before it acts: its roots are off by about one period times the root.
    const double tolerance = 2 * kFast * kPeriod * expected;
    EXPECT_NEAR(-*std::min_element(errors.begin(), errors.end()) / start, expected, tolerance) << ratio;
  }
}

// With kd the sampled loop is e_(n+1) = e_n - Ts (kp e_n + kd (e_n - e_(n-1)) / Ts), kd not knowing a rate in the first tick.
TEST(TactileServo, DerivativeFollowsItsRecursion) {
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

TEST(TactileServo, ClippedTermsAreNoLarger) {
  const auto first = [](const FeatureLoop& loop) { return commandOne(servoOf({{kAngle, loop}}), {.angle = 1.0f}).w[2]; };
  EXPECT_NEAR(first({.kp = 2, .error_limit = 0.1}), 0.2, 0.2 * kFloat);
  EXPECT_NEAR(first({.kp = 0, .ki = 100, .integral_limit = 0.001}), 0.1, 0.1 * kFloat);
  TactileServoController controller(servoOf({{kAngle, {.kd = 0.5, .derivative_limit = 0.3}}}), gridSensor(), 1);
  EXPECT_EQ(commandOne(controller, {.angle = 0.5f}).w[2], 0) << "no rate is known yet";
  EXPECT_NEAR(commandOne(controller, {.angle = 1.0f}).w[2], 0.5 * 0.3, kFloat);
}

// At its speed limit for most of the way, the integral must not charge: the overshoot stays what it is without the limit.
TEST(TactileServo, IntegralWaitsWhileTheSensorIsAtItsLimit) {
  constexpr double kStart = 1.2;
  TactileServo servo = servoOf({{kAngle, {.kp = 2.2, .ki = 0.4}}});
  const auto overshoot = [](const std::vector<double>& errors) { return -*std::min_element(errors.begin(), errors.end()); };
  const double free = overshoot(angleErrors(servo, kStart, 3000));
  servo.max_angular_velocity = 0.2;
  EXPECT_LE(overshoot(angleErrors(servo, kStart, 3000)), free);
}

TEST(TactileServo, TurnsTheShortWayRoundAsLinesDo) {
  const TactileServo servo = servoOf({{kAngle, {.reference = 1.5, .kp = 1}}});
  // From 1.5 on to -1.5 + pi is 0.1416, not -3.
  EXPECT_NEAR(commandOne(servo, {.angle = -1.5f}).w[2], kPi - 3, kFloat);
  EXPECT_NEAR(commandOne(servo, {.angle = 1.4f}).w[2], -0.1, kFloat);
}

TEST(TactileServo, TurnsAboutTheCentreOfPressure) {
  for (const double limit : {10.0, 0.1}) {
    TactileServo servo = servoOf({{kAngle, {.kp = 0.8}}});
    servo.max_angular_velocity = limit;
    const Features features{.angle = 0.5f, .center = {0.006f, -0.015f, 0}};
    const Vector3 contact_W{0.006f, -0.015f, 0};
    constexpr double kShortTime = 1e-3;
    const Pose X_WS = integrate(Pose{}, commandOne(servo, features), kShortTime);
    EXPECT_GT(X_WS.rotation[3], 0);
    const Vector3 contact_S = inverse(X_WS) * contact_W;
    // A rotation about the contact in SE(3) is exact at any angle, so rounding is all there is.
    EXPECT_NEAR(contact_S[0], contact_W[0], 1e-15);
    EXPECT_NEAR(contact_S[1], contact_W[1], 1e-15);
  }
}

TEST(TactileServo, ForceErrorBecomesDepthThroughTheStiffness) {
  const TactileServo servo = servoOf({{kForce, {.kp = 2}}});
  // Object at +z: too low a force drives the sensor up to it.
  const double expected = 2 * (3 - 1) / (kStiffness * 1e-4);
  EXPECT_NEAR(commandOne(servo, {.force = 1, .area = 1e-4f, .target = 3}).v[2], expected, expected * kFloat);
  EXPECT_NEAR(commandOne(servo, {.force = 3, .area = 1e-4f, .target = 1}).v[2], -expected, expected * kFloat);
  const TactileServo fixed = servoOf({{kForce, {.reference = 3, .kp = 2}}});
  EXPECT_NEAR(commandOne(fixed, {.force = 1, .area = 1e-4f, .target = 7}).v[2], expected, expected * kFloat);
}

TEST(TactileServo, StiffnessHasAFloorOfOneTaxel) {
  const TactileServoController controller(edgeServo(), gridSensor(), 1);
  EXPECT_DOUBLE_EQ(controller.contactStiffness(1, 0), kStiffness * kPitch * kPitch);
  EXPECT_DOUBLE_EQ(controller.contactStiffness(1, 1e-3), kStiffness * 1e-3);
}

TEST(TactileServo, StiffnessOfACurvedLawIsItsDerivative) {
  constexpr double kExponent = 2, kDepth = 5e-4, kArea = 1e-4, kDelta = 1e-8;
  const TactileServoController controller(edgeServo(), gridSensor(kExponent), 1);
  const auto force = [&](double depth) { return kStiffness * std::pow(depth, kExponent) * kArea; };
  const double derivative = (force(kDepth + kDelta) - force(kDepth - kDelta)) / (2 * kDelta);
  constexpr double kDifference = 1e-7;  // rounding of the force, 2e-16 kDepth / kDelta = 1e-11, with room
  EXPECT_NEAR(controller.contactStiffness(force(kDepth), kArea), derivative, derivative * kDifference);
  EXPECT_GT(controller.contactStiffness(0, kArea), 0);
}

// The sensor goes after the contact: what was at c comes to the reference.
TEST(TactileServo, CentresAlongTheAxesThatAreSelected) {
  const Features features{.center = {0.004f, -0.003f, 0}};
  const Twist both = commandOne(servoOf({{kX, {.reference = 0.001, .kp = 2}}, {kY, {.kp = 3}}}), features);
  EXPECT_NEAR(both.v[0], 2 * 0.003, 0.008 * kFloat);
  EXPECT_NEAR(both.v[1], 3 * -0.003, 0.009 * kFloat);
  const Twist one = commandOne(servoOf({{kY, {.kp = 3}}}), features);
  EXPECT_EQ(one.v[0], 0);
  EXPECT_EQ(one.v[1], both.v[1]);
  EXPECT_EQ(one.w, (Vector3{0, 0, 0}));
}

TEST(TactileServo, CentresAcrossTheEdgeOnly) {
  const Features features{.angle = static_cast<float>(kPi / 4), .center = {0.004f, 0, 0}};
  const Twist twist = commandOne(servoOf({{kAcross, {.kp = 1}}}), features);
  // Half of (4, 0) mm lies along the diagonal, half across it: (2, -2) mm.
  EXPECT_NEAR(twist.v[0], 0.002, 0.004 * kFloat);
  EXPECT_NEAR(twist.v[1], -0.002, 0.004 * kFloat);
}

TEST(TactileServo, CentresOnTheMiddleOfAllPatches) {
  Sensor sensor = gridSensor();
  sensor.patches[0].X_SP.position = {0.01, 0, 0};
  sensor.patches.push_back({.name = "second", .num_rows = 6, .num_cols = 28, .pitch = {kPitch, kPitch}, .X_SP = {{-0.02, 0.03, 0}, {}}});
  // (84 (10, 0) + 168 (-20, 30)) / 252 = (-10, 20) mm.
  for (const TactileServo& servo : {servoOf({{kAcross, {.kp = 1}}}), servoOf({{kX, {.kp = 1}}, {kY, {.kp = 1}}})}) {
    TactileServoController controller(servo, sensor, 1);
    EXPECT_NEAR(speed(commandOne(controller, {.confidence = 0, .center = {-0.01f, 0.02f, 0}})), 0, 0.02 * kFloat);
  }
}

TEST(TactileServo, ExploresAlongTheEdgeAndDoesNotTurnBackAtTheWrap) {
  TactileServo servo = servoOf({{kAngle, {.reference = kPi / 2}}});
  servo.exploration_velocity = 0.01;
  for (const double angle : {kPi / 2 - 0.1, -kPi / 2 + 0.1}) {
    const Twist twist = commandOne(servo, {.angle = static_cast<float>(angle)});
    EXPECT_NEAR(speed(twist), 0.01, 0.01 * kFloat);
    EXPECT_NEAR(twist.v[1], 0.01 * std::cos(0.1), 0.01 * kFloat) << angle;
  }
}

TEST(TactileServo, LeavesTheAngleAloneBelowMinConfidence) {
  TactileServo servo = edgeServo();
  servo.exploration_velocity = 0.01;
  servo.max_linear_velocity = 1;
  servo.min_confidence = 0.5;
  EXPECT_GT(commandOne(servo, {.angle = 0.5f, .confidence = 0.5f}).w[2], 0);
  const Twist twist = commandOne(servo, {.angle = 0.5f, .confidence = 0.49f, .force = 1, .center = {0.003f, 0.004f, 0}});
  EXPECT_EQ(twist.w[2], 0);
  EXPECT_NEAR(twist.v[0], 0.003, 0.003 * kFloat);  // without an edge both directions are centred
  EXPECT_NEAR(twist.v[1], 0.004, 0.004 * kFloat);
  EXPECT_GT(twist.v[2], 0);
}

TEST(TactileServo, ApproachesSlowlyWithoutContact) {
  TactileServo servo = edgeServo();
  servo.exploration_velocity = 0.01;
  const Twist twist = commandOne(servo, {.angle = 0.5f, .force = 0, .area = 0});
  EXPECT_EQ(twist.v[0], 0);
  EXPECT_EQ(twist.v[1], 0);
  EXPECT_EQ(twist.w, (Vector3{0, 0, 0}));
  EXPECT_GT(twist.v[2], 0);
  EXPECT_LE(twist.v[2], servo.max_linear_velocity / 2);
  EXPECT_EQ(commandOne(servo, {.force = 0, .area = 0, .target = 0}), Twist{});
  EXPECT_EQ(commandOne(servoOf({{kAngle, {.kp = 1}}}), {.force = 0, .area = 0}), Twist{}) << "no force is to be held";
}

// Lost and met again, the contact's rate across the gap is not one.
TEST(TactileServo, ForgetsItsRateWithTheContact) {
  const TactileServo servo = servoOf({{kAngle, {.kd = 0.5}}});
  TactileServoController controller(servo, gridSensor(), 1);
  commandOne(controller, {.angle = 0.1f});
  commandOne(controller, {.force = 0, .area = 0});
  EXPECT_EQ(commandOne(controller, {.angle = 0.9f}).w[2], 0);
}

TEST(TactileServo, ResetForgetsOneInstance) {
  TactileServoController controller(servoOf({{kAngle, {.kp = 1, .ki = 10}}}), gridSensor(), 2);
  const std::vector<float> angle{0.5f, 0.5f}, one{1, 1}, area{1e-4f, 1e-4f}, center(6, 0.0f);
  const std::vector<std::uint8_t> due{1, 1};
  std::vector<Twist> first(2), second(2);
  controller.command(inputOf(angle, one, one, center, area, one, due), kPeriod, first);
  controller.reset(1);
  controller.command(inputOf(angle, one, one, center, area, one, due), kPeriod, second);
  EXPECT_NE(second[0], first[0]);
  EXPECT_EQ(second[1], first[1]);
}

TEST(TactileServo, LeavesInstancesAloneThatAreNotDue) {
  TactileServoController controller(edgeServo(), gridSensor(), 2);
  const std::vector<float> angle{0.5f, 0.5f}, one{1, 1}, area{1e-4f, 1e-4f}, center(6, 0.0f);
  const std::vector<std::uint8_t> due{0, 1};
  const Twist held{{1, 2, 3}, {4, 5, 6}};
  std::vector<Twist> twists{held, held};
  controller.command(inputOf(angle, one, one, center, area, one, due), kPeriod, twists);
  EXPECT_EQ(twists[0], held);
  EXPECT_NE(twists[1], held);
}

TEST(TactileServo, HoldsAnInstanceStillWhoseFeaturesAreNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  TactileServoController controller(edgeServo(), gridSensor(), 2), alone(edgeServo(), gridSensor(), 1);
  const std::vector<float> angle{nan, 0.5f}, one{1, 1}, area{1e-4f, 1e-4f}, center(6, 0.0f);
  const std::vector<std::uint8_t> due{1, 1};
  std::vector<Twist> twists(2);
  controller.command(inputOf(angle, one, one, center, area, one, due), kPeriod, twists);
  EXPECT_EQ(twists[0], Twist{});
  EXPECT_EQ(twists[1], commandOne(alone, {.angle = 0.5f, .force = 1, .area = 1e-4f, .target = 1}));
}

TEST(TactileServo, RefusesGainsReferencesAndLimitsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<TactileServo> bad{TactileServo{}};
  for (const FeatureLoop& loop :
       {FeatureLoop{.kp = -1}, FeatureLoop{.kp = nan}, FeatureLoop{.ki = 1 / 0.0}, FeatureLoop{.kd = 1}, FeatureLoop{.reference = nan},
        FeatureLoop{.error_limit = 0}, FeatureLoop{.integral_limit = nan}, FeatureLoop{.derivative_limit = -1}}) {
    bad.push_back(servoOf({{kForce, loop}}));
  }
  bad.push_back(servoOf({{kAcross, {.kp = 1}}, {kX, {.kp = 1}}}));
  for (const auto& change :
       std::initializer_list<void (*)(TactileServo&, double)>{[](TactileServo&servo, double value) { servo.exploration_velocity = value; },
                                                              [](TactileServo&servo, double value) { servo.max_angular_velocity = value; },
                                                              [](TactileServo&servo, double value) { servo.max_linear_velocity = value; },
                                                              [](TactileServo&servo, double value) { servo.min_confidence = value; }}) {
    change(bad.emplace_back(edgeServo()), nan);
  }
  for (const TactileServo& servo : bad) EXPECT_THROW(TactileServoController(servo, gridSensor(), 1), Error);
  EXPECT_NO_THROW(TactileServoController(edgeServo(), gridSensor(), 1));
}

Features drawFeatures() {
  const auto draw = [](double min, double max) {
    return static_cast<float>(min + (max - min) * *rc::gen::inRange(0, 1 << 20) / double{1 << 20});
  };
  return {.angle = draw(-kPi / 2, kPi / 2),
          .confidence = draw(0, 1),
          .force = draw(-0.2, 5),
          .area = draw(0, 1e-3),
          .target = draw(0, 5),
          .center = {draw(-0.03, 0.03), draw(-0.03, 0.03), 0}};
}

RC_GTEST_PROP(TactileServoProperty, KeepsTheLimits, ()) {
  TactileServo servo{.exploration_velocity = 0.03, .max_angular_velocity = 0.7};
  servo[kAngle] = {.selected = true, .kp = 5, .ki = 3, .kd = 0.5};
  servo[kForce] = {.selected = true, .kp = 50, .ki = 20, .kd = 0.9};
  servo[kAcross] = {.selected = true, .kp = 5, .ki = 3, .kd = 0.5};
  TactileServoController controller(servo, gridSensor(), 1);
  for (int tick = 0; tick < 4; ++tick) {
    const Twist twist = commandOne(controller, drawFeatures());
    RC_ASSERT(std::abs(twist.w[2]) <= servo.max_angular_velocity * (1 + kSpeedRounding));
    RC_ASSERT(twist.w[0] == 0 && twist.w[1] == 0);
    RC_ASSERT(speed(twist) <= servo.max_linear_velocity * (1 + kSpeedRounding));
  }
}

// Instance i in a batch equals instance i alone, to the bit, tick after tick.
RC_GTEST_PROP(TactileServoProperty, DoesNotDependOnTheBatch, ()) {
  TactileServo servo = edgeServo();
  servo.exploration_velocity = 0.005;
  for (FeatureLoop& loop : servo.loops) loop.ki = 0.5, loop.kd = 0.3;
  const int num_instances = *rc::gen::inRange(1, 20);
  const auto n = static_cast<std::size_t>(num_instances);
  TactileServoController controller(servo, gridSensor(1.5), num_instances);
  std::vector<TactileServoController> alone;
  for (std::size_t i = 0; i < n; ++i) alone.emplace_back(servo, gridSensor(1.5), 1);
  for (int tick = 0; tick < 3; ++tick) {
    std::vector<Features> features(n);
    std::vector<float> angle, confidence, force, center, area, target;
    for (Features& f : features) {
      f = drawFeatures();
      angle.push_back(f.angle);
      confidence.push_back(f.confidence);
      force.push_back(f.force);
      center.insert(center.end(), f.center.begin(), f.center.end());
      area.push_back(f.area);
      target.push_back(f.target);
    }
    const std::vector<std::uint8_t> due(n, 1);
    std::vector<Twist> twists(n);
    controller.command(inputOf(angle, confidence, force, center, area, target, due), kPeriod, twists);
    for (std::size_t i = 0; i < n; ++i) {
      const Twist one = commandOne(alone[i], features[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        RC_ASSERT(std::bit_cast<std::uint64_t>(twists[i].v[k]) == std::bit_cast<std::uint64_t>(one.v[k]));
        RC_ASSERT(std::bit_cast<std::uint64_t>(twists[i].w[k]) == std::bit_cast<std::uint64_t>(one.w[k]));
      }
    }
  }
}

}  // namespace
}  // namespace taxelsim
