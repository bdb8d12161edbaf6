#include "control/edge_servo.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

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

Twist commandOne(const EdgeServoController& controller, const Features& f) {
  Twist twist;
  const std::uint8_t due = 1;
  controller.command({.edge_angle = {&f.angle, 1},
                      .edge_confidence = {&f.confidence, 1},
                      .total_force = {&f.force, 1},
                      .center_of_pressure = f.center,
                      .contact_area = {&f.area, 1},
                      .target_force = {&f.target, 1},
                      .due = {&due, 1}},
                     {&twist, 1});
  return twist;
}

Twist commandOne(const EdgeServo& servo, const Features& f) {
  return commandOne(EdgeServoController(servo, gridSensor()), f);
}

double speed(const Twist& t) {
  return std::sqrt(t.v[0] * t.v[0] + t.v[1] * t.v[1] + t.v[2] * t.v[2]);
}

TEST(EdgeServo, StandsStillAtTheTarget) {
  EXPECT_EQ(commandOne(EdgeServo{}, Features{}), Twist{});
}

// A line fixed in the world, seen from the turning sensor: e falls as (1 - K Ts)^n.
TEST(EdgeServo, AngleErrorDecaysAsTheSampledLaw) {
  constexpr double kGain = 0.78, kPeriod = 0.01, kStart = 0.6;
  constexpr int kSteps = 500;
  const EdgeServo servo{.angle_gain = kGain, .target_angle = 0.2};
  const EdgeServoController controller(servo, gridSensor());
  Pose X_WS;
  const double line_W = servo.target_angle + kStart;
  for (int n = 0; n < kSteps; ++n) {
    const double yaw = 2 * std::atan2(X_WS.rotation[3], X_WS.rotation[0]);
    const double error = line_W - yaw - servo.target_angle;
    ASSERT_NEAR(error, kStart * std::pow(1 - kGain * kPeriod, n), (n + 1) * kFloat) << "step " << n;
    X_WS = integrate(X_WS, commandOne(controller, {.angle = static_cast<float>(line_W - yaw)}), kPeriod);
  }
}

TEST(EdgeServo, TurnsTheShortWayRoundAsLinesDo) {
  const EdgeServo servo{.angle_gain = 1, .target_angle = 1.5, .max_angular_velocity = 10};
  // From 1.5 on to -1.5 + pi is 0.1416, not -3.
  EXPECT_NEAR(commandOne(servo, {.angle = -1.5f}).w[2], kPi - 3, kFloat);
  EXPECT_NEAR(commandOne(servo, {.angle = 1.4f}).w[2], -0.1, kFloat);
}

TEST(EdgeServo, TurnsAboutTheCentreOfPressure) {
  const EdgeServo servo{.centre_gain = 0, .max_linear_velocity = 1};
  const Features features{.angle = 0.5f, .center = {0.006f, -0.015f, 0}};
  Pose X_WS;
  const Vector3 contact_W{0.006f, -0.015f, 0};
  constexpr double kShortTime = 1e-3;
  X_WS = integrate(X_WS, commandOne(servo, features), kShortTime);
  EXPECT_GT(X_WS.rotation[3], 0);
  const Vector3 contact_S = inverse(X_WS) * contact_W;
  // A rotation about the contact in SE(3) is exact at any angle, so rounding is all there is.
  EXPECT_NEAR(contact_S[0], contact_W[0], 1e-15);
  EXPECT_NEAR(contact_S[1], contact_W[1], 1e-15);
}

TEST(EdgeServo, ForceErrorBecomesDepthThroughTheStiffness) {
  const EdgeServo servo{.force_gain = 2, .max_linear_velocity = 1};
  const Features low{.force = 1, .area = 1e-4f, .target = 3};
  // Object at +z: too low a force drives the sensor up to it.
  const double expected = 2 * (3 - 1) / (kStiffness * 1e-4);
  EXPECT_NEAR(commandOne(servo, low).v[2], expected, expected * kFloat);
  const Features high{.force = 3, .area = 1e-4f, .target = 1};
  EXPECT_NEAR(commandOne(servo, high).v[2], -expected, expected * kFloat);
}

TEST(EdgeServo, StiffnessHasAFloorOfOneTaxel) {
  const EdgeServoController controller(EdgeServo{}, gridSensor());
  EXPECT_DOUBLE_EQ(controller.contactStiffness(1, 0), kStiffness * kPitch * kPitch);
  EXPECT_DOUBLE_EQ(controller.contactStiffness(1, 1e-3), kStiffness * 1e-3);
}

TEST(EdgeServo, StiffnessOfACurvedLawIsItsDerivative) {
  constexpr double kExponent = 2, kDepth = 5e-4, kArea = 1e-4, kDelta = 1e-8;
  const EdgeServoController controller(EdgeServo{}, gridSensor(kExponent));
  const auto force = [&](double depth) { return kStiffness * std::pow(depth, kExponent) * kArea; };
  const double derivative = (force(kDepth + kDelta) - force(kDepth - kDelta)) / (2 * kDelta);
  constexpr double kDifference = 1e-7;  // rounding of the force, 2e-16 kDepth / kDelta = 1e-11, with room
  EXPECT_NEAR(controller.contactStiffness(force(kDepth), kArea), derivative, derivative * kDifference);
  EXPECT_GT(controller.contactStiffness(0, kArea), 0);
}

TEST(EdgeServo, CentresAcrossTheEdgeOnly) {
  const EdgeServo servo{.angle_gain = 0, .centre_gain = 1, .max_linear_velocity = 1};
  const Features features{.angle = static_cast<float>(kPi / 4), .center = {0.004f, 0, 0}};
  const Twist twist = commandOne(servo, features);
  // Half of (4, 0) mm lies along the diagonal, half across it: (2, -2) mm.
  EXPECT_NEAR(twist.v[0], 0.002, 0.004 * kFloat);
  EXPECT_NEAR(twist.v[1], -0.002, 0.004 * kFloat);
}

TEST(EdgeServo, CentresOnTheMiddleOfAllPatches) {
  Sensor sensor = gridSensor();
  sensor.patches[0].X_SP.position = {0.01, 0, 0};
  sensor.patches.push_back({.name = "second", .num_rows = 6, .num_cols = 28, .pitch = {kPitch, kPitch}, .X_SP = {{-0.02, 0.03, 0}, {}}});
  const EdgeServoController controller({.angle_gain = 0}, sensor);
  // (84 (10, 0) + 168 (-20, 30)) / 252 = (-10, 20) mm.
  const Twist twist = commandOne(controller, {.confidence = 0, .center = {-0.01f, 0.02f, 0}});
  EXPECT_NEAR(speed(twist), 0, 0.02 * kFloat);
}

TEST(EdgeServo, ExploresAlongTheEdgeAndDoesNotTurnBackAtTheWrap) {
  const EdgeServo servo{.angle_gain = 0, .centre_gain = 0, .target_angle = kPi / 2, .exploration_velocity = 0.01};
  for (const double angle : {kPi / 2 - 0.1, -kPi / 2 + 0.1}) {
    const Twist twist = commandOne(servo, {.angle = static_cast<float>(angle)});
    EXPECT_NEAR(speed(twist), 0.01, 0.01 * kFloat);
    EXPECT_NEAR(twist.v[1], 0.01 * std::cos(0.1), 0.01 * kFloat) << angle;
  }
}

TEST(EdgeServo, LeavesTheAngleAloneBelowMinConfidence) {
  const EdgeServo servo{.exploration_velocity = 0.01, .max_linear_velocity = 1, .min_confidence = 0.5};
  EXPECT_GT(commandOne(servo, {.angle = 0.5f, .confidence = 0.5f}).w[2], 0);
  const Twist twist = commandOne(servo, {.angle = 0.5f, .confidence = 0.49f, .force = 1, .center = {0.003f, 0.004f, 0}});
  EXPECT_EQ(twist.w[2], 0);
  EXPECT_NEAR(twist.v[0], 0.003, 0.003 * kFloat);  // without an edge both directions are centred
  EXPECT_NEAR(twist.v[1], 0.004, 0.004 * kFloat);
  EXPECT_GT(twist.v[2], 0);
}

TEST(EdgeServo, ApproachesSlowlyWithoutContact) {
  const EdgeServo servo{.exploration_velocity = 0.01};
  const Twist twist = commandOne(servo, {.angle = 0.5f, .force = 0, .area = 0});
  EXPECT_EQ(twist.v[0], 0);
  EXPECT_EQ(twist.v[1], 0);
  EXPECT_EQ(twist.w, (Vector3{0, 0, 0}));
  EXPECT_GT(twist.v[2], 0);
  EXPECT_LE(twist.v[2], servo.max_linear_velocity / 2);
  EXPECT_EQ(commandOne(servo, {.force = 0, .area = 0, .target = 0}), Twist{});
}

TEST(EdgeServo, LeavesInstancesAloneThatAreNotDue) {
  const EdgeServoController controller(EdgeServo{}, gridSensor());
  const std::vector<float> angle{0.5f, 0.5f}, one{1, 1}, area{1e-4f, 1e-4f}, center(6, 0.0f);
  const std::vector<std::uint8_t> due{0, 1};
  const Twist held{{1, 2, 3}, {4, 5, 6}};
  std::vector<Twist> twists{held, held};
  controller.command({angle, one, one, center, area, one, due}, twists);
  EXPECT_EQ(twists[0], held);
  EXPECT_NE(twists[1], held);
}

TEST(EdgeServo, RefusesGainsAndLimitsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const EdgeServo& servo :
       {EdgeServo{.angle_gain = -1}, EdgeServo{.force_gain = nan}, EdgeServo{.centre_gain = 1 / 0.0}, EdgeServo{.target_angle = nan},
        EdgeServo{.exploration_velocity = nan}, EdgeServo{.max_angular_velocity = 0}, EdgeServo{.max_linear_velocity = nan},
        EdgeServo{.min_confidence = 1.5}}) {
    EXPECT_THROW(EdgeServoController(servo, gridSensor()), Error);
  }
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

RC_GTEST_PROP(EdgeServoProperty, KeepsTheLimits, ()) {
  const EdgeServo servo{.angle_gain = 5, .force_gain = 50, .centre_gain = 5, .exploration_velocity = 0.03, .max_angular_velocity = 0.7};
  const Twist twist = commandOne(servo, drawFeatures());
  RC_ASSERT(std::abs(twist.w[2]) <= servo.max_angular_velocity);
  RC_ASSERT(twist.w[0] == 0 && twist.w[1] == 0);
  RC_ASSERT(speed(twist) <= servo.max_linear_velocity * (1 + kSpeedRounding));
}

// Instance i in a batch equals instance i alone, to the bit.
RC_GTEST_PROP(EdgeServoProperty, DoesNotDependOnTheBatch, ()) {
  const EdgeServoController controller({.exploration_velocity = 0.005}, gridSensor(1.5));
  const std::size_t num_instances = *rc::gen::inRange(1, 20);
  std::vector<Features> features(num_instances);
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
  const std::vector<std::uint8_t> due(num_instances, 1);
  std::vector<Twist> twists(num_instances);
  controller.command({angle, confidence, force, center, area, target, due}, twists);
  for (std::size_t i = 0; i < num_instances; ++i) {
    const Twist alone = commandOne(controller, features[i]);
    for (int k = 0; k < 3; ++k) {
      RC_ASSERT(std::bit_cast<std::uint64_t>(twists[i].v[k]) == std::bit_cast<std::uint64_t>(alone.v[k]));
      RC_ASSERT(std::bit_cast<std::uint64_t>(twists[i].w[k]) == std::bit_cast<std::uint64_t>(alone.w[k]));
    }
  }
}

}  // namespace
}  // namespace taxelsim
