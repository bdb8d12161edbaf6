#include "control/twist.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

namespace taxelsim {
namespace {

// Some tens of roundings on numbers of order 1 and 10, and at most 2^kHalvings times those of one small step.
constexpr double kRounding = 1e-13;

double drawBetween(double min, double max) {
  return min + (max - min) * (*rc::gen::inRange(0, 1 << 30)) / static_cast<double>(1 << 30);
}

Vector3 drawVector(double size) {
  return {drawBetween(-size, size), drawBetween(-size, size), drawBetween(-size, size)};
}

Twist drawTwist() {
  // Angles from far below the switch to series to about two turns.
  const double angular = std::pow(10.0, drawBetween(-8, 1));
  return {drawVector(1), drawVector(angular)};
}

Pose drawPose() {
  return {drawVector(1), axisAngle({drawBetween(0.1, 1), drawBetween(-1, 1), drawBetween(-1, 1)}, drawBetween(-3, 3))};
}

void expectNear(const Pose& a, const Pose& b, double tolerance) {
  const double sign =
      a.rotation[0] * b.rotation[0] + a.rotation[1] * b.rotation[1] + a.rotation[2] * b.rotation[2] + a.rotation[3] * b.rotation[3] < 0 ? -1
                                                                                                                                        : 1;
  for (int i = 0; i < 3; ++i) RC_ASSERT(std::abs(a.position[i] - b.position[i]) <= tolerance);
  for (int i = 0; i < 4; ++i) RC_ASSERT(std::abs(a.rotation[i] - sign * b.rotation[i]) <= tolerance);
}

TEST(Exponential, OfNoTwistIsExactlyNoMotion) {
  EXPECT_EQ(exponential({}, 0.01), Pose{});
}

TEST(Exponential, OfATranslationIsAStraightLine) {
  const Pose X = exponential({{1, -2, 3}, {0, 0, 0}}, 0.25);
  EXPECT_EQ(X, (Pose{{0.25, -0.5, 0.75}, {1, 0, 0, 0}}));
}

TEST(Exponential, QuarterTurnOnACircle) {
  // Along x at 1 m/s, turning left at pi/2 rad/s: after 1 s a quarter of a circle of radius 2/pi, centred on y = 2/pi.
  const Pose X = exponential({{1, 0, 0}, {0, 0, std::numbers::pi / 2}}, 1);
  const double radius = 2 / std::numbers::pi;
  EXPECT_NEAR(X.position[0], radius, kRounding);
  EXPECT_NEAR(X.position[1], radius, kRounding);
  EXPECT_NEAR(X.position[2], 0, kRounding);
  EXPECT_NEAR(X.rotation[0], std::sqrt(0.5), kRounding);
  EXPECT_NEAR(X.rotation[3], std::sqrt(0.5), kRounding);
}

RC_GTEST_PROP(Exponential, TwoHalvesMakeAWhole, ()) {
  const Twist twist = drawTwist();
  const Pose half = exponential(twist, 0.5);
  expectNear(exponential(twist, 1), half * half, kRounding);
}

// Against the definition: the limit of many small steps, (1 + twist / n)^n. One step is wrong by (w^2 + |w| |v|) / (2 n^2).
RC_GTEST_PROP(Exponential, IsTheLimitOfSmallSteps, ()) {
  constexpr int kHalvings = 26;
  constexpr double kLimit = 1e-5;  // size 10 sqrt(3): 300 / 2 / 2^26 = 2.2e-6, and as much again for the translation it swings
  const Twist twist = drawTwist();
  const double dt = std::ldexp(1.0, -kHalvings);
  Pose X{{twist.v[0] * dt, twist.v[1] * dt, twist.v[2] * dt}, {1, twist.w[0] * dt / 2, twist.w[1] * dt / 2, twist.w[2] * dt / 2}};
  for (int i = 0; i < kHalvings; ++i) X = X * X;
  expectNear(exponential(twist, 1), X, kLimit);
}

RC_GTEST_PROP(Exponential, BackAndForthIsNoMotion, ()) {
  const Twist twist = drawTwist();
  expectNear(exponential(twist, 1), inverse(exponential(twist, -1)), kRounding);
}

// Driving B, or A with the changed twist, moves the same body.
RC_GTEST_PROP(ChangeFrame, MovesTheSameBody, ()) {
  const Pose X_AB = drawPose();
  const Pose X_WA = drawPose();
  const Twist twist_B = drawTwist();
  const Pose by_B = integrate(X_WA * X_AB, twist_B, 0.1);
  const Pose by_A = integrate(X_WA, changeFrame(X_AB, twist_B), 0.1) * X_AB;
  expectNear(by_A, by_B, kRounding);
}

}  // namespace
}  // namespace taxelsim
