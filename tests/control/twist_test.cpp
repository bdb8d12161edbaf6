#include "control/twist.h"

#include "random_robots.h"
#include "support/test.h"

namespace taxelsim {
namespace {

// Tens of rounding errors of numbers of order 1 and 10.
constexpr double kRounding = 1e-13;

Twist drawTwist() {
  // Angles from far below the switch to Taylor series up to about two full rotations.
  const double angular = std::pow(10.0, drawBetween(-8, 1));
  return {drawVector(1), drawVector(angular)};
}

void expectNear(const Pose& a, const Pose& b, double tolerance) {
  RC_ASSERT(distance(a, b) <= tolerance);
}

TEST(Exponential, OfZeroIsTheIdentity) {
  EXPECT_EQ(exponential({}, 0.01), Pose{});
}

TEST(Exponential, OfATranslationIsAStraightLine) {
  const Pose X = exponential({{1, -2, 3}, {0, 0, 0}}, 0.25);
  EXPECT_EQ(X, (Pose{{0.25, -0.5, 0.75}, {1, 0, 0, 0}}));
}

TEST(Exponential, OfAPlanarTwistIsAnArc) {
  // 1 m/s along x and pi/2 rad/s about z: after 1 s a quarter of a circle of radius 2/pi with its center at y = 2/pi.
  const Pose X = exponential({{1, 0, 0}, {0, 0, std::numbers::pi / 2}}, 1);
  const double radius = 2 / std::numbers::pi;
  EXPECT_NEAR(X.position[0], radius, kRounding);
  EXPECT_NEAR(X.position[1], radius, kRounding);
  EXPECT_NEAR(X.position[2], 0, kRounding);
  EXPECT_NEAR(X.rotation[0], std::sqrt(0.5), kRounding);
  EXPECT_NEAR(X.rotation[3], std::sqrt(0.5), kRounding);
}

RC_GTEST_PROP(Exponential, IsASemigroup, ()) {
  const Twist twist = drawTwist();
  const Pose half = exponential(twist, 0.5);
  expectNear(exponential(twist, 1), half * half, kRounding);
}

// The definition as a limit: (1 + twist / n)^n. The error of one step is (w^2 + |w| |v|) / (2 n^2).
RC_GTEST_PROP(Exponential, IsTheLimitOfSmallSteps, ()) {
  constexpr int kHalvings = 26;
  constexpr double kLimit = 1e-5;  // |w| <= 10 sqrt(3): 300 / 2 / 2^26 = 2.2e-6 for the rotation, and as much for the translation
  const Twist twist = drawTwist();
  const double dt = std::ldexp(1.0, -kHalvings);
  Pose X{{twist.v[0] * dt, twist.v[1] * dt, twist.v[2] * dt}, {1, twist.w[0] * dt / 2, twist.w[1] * dt / 2, twist.w[2] * dt / 2}};
  for (int i = 0; i < kHalvings; ++i) X = X * X;
  expectNear(exponential(twist, 1), X, kLimit);
}

RC_GTEST_PROP(Exponential, OfTheNegativeTwistIsTheInverse, ()) {
  const Twist twist = drawTwist();
  expectNear(exponential(twist, 1), inverse(exponential(twist, -1)), kRounding);
}

// Integrating the twist of B, or the twist of A on the same body, gives the same motion.
RC_GTEST_PROP(ChangeFrame, DescribesTheSameMotion, ()) {
  const Pose X_AB = drawPose(1);
  const Pose X_WA = drawPose(1);
  const Twist twist_B = drawTwist();
  const Pose by_B = integrate(X_WA * X_AB, twist_B, 0.1);
  const Pose by_A = integrate(X_WA, changeFrame(X_AB, twist_B), 0.1) * X_AB;
  expectNear(by_A, by_B, kRounding);
}

}  // namespace
}  // namespace taxelsim
