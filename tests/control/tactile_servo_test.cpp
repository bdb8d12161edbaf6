// Maps from feature errors to the twist of the sensor, with the nominal Jacobian.
#include "control/tactile_servo.h"

#include "control/twist.h"
#include "servo_fixtures.h"
#include "support/test.h"

namespace taxelsim {
namespace {

TEST(TactileServo, TwistIsZeroAtTheReference) {
  EXPECT_EQ(commandOne(edgeServo(), Features{}), Twist{});
}

TEST(TactileServo, WrapsAngleErrorsModuloPi) {
  const TactileServo servo = servoOf({{kAngle, {.reference = 1.5, .kp = 1}}});
  // The error from 1.5 to -1.5 + pi is 0.1416, not -3.
  EXPECT_NEAR(commandOne(servo, {.angle = -1.5f}).w[2], kPi - 3, kFloat);
  EXPECT_NEAR(commandOne(servo, {.angle = 1.4f}).w[2], -0.1, kFloat);
}

TEST(TactileServo, RotatesAboutTheCenterOfPressure) {
  for (const double limit : {10.0, 0.1}) {
    TactileServo servo = servoOf({{kAngle, {.kp = 0.8}}});
    servo.max_angular_velocity = limit;
    const Features features{.angle = 0.5f, .center = {0.006f, -0.015f, 0}};
    const Vector3 contact_W{0.006f, -0.015f, 0};
    constexpr double kShortTime = 1e-3;
    const Pose X_WS = integrate(Pose{}, commandOne(servo, features), kShortTime);
    EXPECT_GT(X_WS.rotation[3], 0);
    const Vector3 contact_S = inverse(X_WS) * contact_W;
    // The exponential of a rotation about the contact is exact at any angle: only rounding remains.
    EXPECT_NEAR(contact_S[0], contact_W[0], 1e-15);
    EXPECT_NEAR(contact_S[1], contact_W[1], 1e-15);
  }
}

TEST(TactileServo, DividesForceErrorByTheContactStiffness) {
  const TactileServo servo = servoOf({{kForce, {.kp = 2}}});
  // The object is at +z: a force below the reference moves the sensor along +z.
  const double expected = 2 * (3 - 1) / (kStiffness * 1e-4);
  EXPECT_NEAR(commandOne(servo, {.force = 1, .area = 1e-4f, .target = 3}).v[2], expected, expected * kFloat);
  EXPECT_NEAR(commandOne(servo, {.force = 3, .area = 1e-4f, .target = 1}).v[2], -expected, expected * kFloat);
  const TactileServo fixed = servoOf({{kForce, {.reference = 3, .kp = 2}}});
  EXPECT_NEAR(commandOne(fixed, {.force = 1, .area = 1e-4f, .target = 7}).v[2], expected, expected * kFloat);
}

TEST(TactileServo, ContactStiffnessHasTheAreaOfATaxelAtLeast) {
  const TactileServoController controller(edgeServo(), gridSensor(), 1);
  EXPECT_DOUBLE_EQ(controller.contactStiffness(1, 0), kStiffness * kPitch * kPitch);
  EXPECT_DOUBLE_EQ(controller.contactStiffness(1, 1e-3), kStiffness * 1e-3);
}

TEST(TactileServo, ContactStiffnessOfANonlinearLawIsItsDerivative) {
  constexpr double kExponent = 2, kDepth = 5e-4, kArea = 1e-4, kDelta = 1e-8;
  const TactileServoController controller(edgeServo(), gridSensor(kExponent), 1);
  const auto force = [&](double depth) { return kStiffness * std::pow(depth, kExponent) * kArea; };
  const double derivative = (force(kDepth + kDelta) - force(kDepth - kDelta)) / (2 * kDelta);
  constexpr double kDifference = 1e-7;  // rounding errors of the force are 2e-16 kDepth / kDelta = 1e-11
  EXPECT_NEAR(controller.contactStiffness(force(kDepth), kArea), derivative, derivative * kDifference);
  EXPECT_GT(controller.contactStiffness(0, kArea), 0);
}

// The sensor follows the contact: the center c moves to the reference.
TEST(TactileServo, CentersAlongSelectedAxes) {
  const Features features{.center = {0.004f, -0.003f, 0}};
  const Twist both = commandOne(servoOf({{kX, {.reference = 0.001, .kp = 2}}, {kY, {.kp = 3}}}), features);
  EXPECT_NEAR(both.v[0], 2 * 0.003, 0.008 * kFloat);
  EXPECT_NEAR(both.v[1], 3 * -0.003, 0.009 * kFloat);
  const Twist one = commandOne(servoOf({{kY, {.kp = 3}}}), features);
  EXPECT_EQ(one.v[0], 0);
  EXPECT_EQ(one.v[1], both.v[1]);
  EXPECT_EQ(one.w, (Vector3{0, 0, 0}));
}

TEST(TactileServo, CentersAcrossTheEdgeOnly) {
  const Features features{.angle = static_cast<float>(kPi / 4), .center = {0.004f, 0, 0}};
  const Twist twist = commandOne(servoOf({{kAcross, {.kp = 1}}}), features);
  // The component of (4, 0) mm normal to the diagonal is (2, -2) mm.
  EXPECT_NEAR(twist.v[0], 0.002, 0.004 * kFloat);
  EXPECT_NEAR(twist.v[1], -0.002, 0.004 * kFloat);
}

TEST(TactileServo, CenterReferenceIsTheMeanOfAllTaxels) {
  Sensor sensor = gridSensor();
  sensor.patches[0].X_SP.position = {0.01, 0, 0};
  sensor.patches.push_back({.name = "second", .num_rows = 6, .num_cols = 28, .pitch = {kPitch, kPitch}, .X_SP = {{-0.02, 0.03, 0}, {}}});
  // (84 (10, 0) + 168 (-20, 30)) / 252 = (-10, 20) mm.
  for (const TactileServo& servo : {servoOf({{kAcross, {.kp = 1}}}), servoOf({{kX, {.kp = 1}}, {kY, {.kp = 1}}})}) {
    TactileServoController controller(servo, sensor, 1);
    EXPECT_NEAR(speed(commandOne(controller, {.confidence = 0, .center = {-0.01f, 0.02f, 0}})), 0, 0.02 * kFloat);
  }
}

TEST(TactileServo, ExplorationKeepsItsDirectionWhereTheAngleWraps) {
  TactileServo servo = servoOf({{kAngle, {.reference = kPi / 2}}});
  servo.exploration_velocity = 0.01;
  for (const double angle : {kPi / 2 - 0.1, -kPi / 2 + 0.1}) {
    const Twist twist = commandOne(servo, {.angle = static_cast<float>(angle)});
    EXPECT_NEAR(speed(twist), 0.01, 0.01 * kFloat);
    EXPECT_NEAR(twist.v[1], 0.01 * std::cos(0.1), 0.01 * kFloat) << angle;
  }
}

TEST(TactileServo, IgnoresTheAngleBelowMinConfidence) {
  TactileServo servo = edgeServo();
  servo.exploration_velocity = 0.01;
  servo.max_linear_velocity = 1;
  servo.min_confidence = 0.5;
  EXPECT_GT(commandOne(servo, {.angle = 0.5f, .confidence = 0.5f}).w[2], 0);
  const Twist twist = commandOne(servo, {.angle = 0.5f, .confidence = 0.49f, .force = 1, .center = {0.003f, 0.004f, 0}});
  EXPECT_EQ(twist.w[2], 0);
  EXPECT_NEAR(twist.v[0], 0.003, 0.003 * kFloat);  // without an edge, both directions are controlled
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
  EXPECT_EQ(commandOne(servoOf({{kAngle, {.kp = 1}}}), {.force = 0, .area = 0}), Twist{}) << "the force is not controlled";
}

// No derivative across a gap between two contacts.
TEST(TactileServo, LossOfContactResetsTheDerivative) {
  const TactileServo servo = servoOf({{kAngle, {.kd = 0.5}}});
  TactileServoController controller(servo, gridSensor(), 1);
  commandOne(controller, {.angle = 0.1f});
  commandOne(controller, {.force = 0, .area = 0});
  EXPECT_EQ(commandOne(controller, {.angle = 0.9f}).w[2], 0);
}

}  // namespace
}  // namespace taxelsim
