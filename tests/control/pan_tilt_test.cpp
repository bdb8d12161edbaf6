// The pan-tilt platform: kinematics, position steps, delay, limits.
#include "control/robots.h"

#include "example_robots.h"
#include "random_robots.h"
#include "support/test.h"

namespace taxelsim {
namespace {

// Pan rotates about z of the base, tilt about y of the pan link.
RC_GTEST_PROP(PanTiltRobots, MatchTheClosedFormOfTheirKinematics, ()) {
  const Pose X_LS = drawPose(0.1);
  const Manipulator platform = panTilt({.tilt_height = 0.07, .sensors = {{"tilt", X_LS}, {"pan", X_LS}, {"base", X_LS}}});
  const double pan = 0.29 * kPi / 180 * *rc::gen::inRange(-500, 500), tilt = 0.29 * kPi / 180 * *rc::gen::inRange(-500, 500);
  Robots robots(platform, 1);
  robots.reset(0, std::vector{pan, tilt});
  const Pose X_pan{{0, 0, 0}, axisAngle({0, 0, 1}, pan)};
  const Pose X_tilt = X_pan * Pose{{0, 0, 0.07}, axisAngle({0, 1, 0}, tilt)};
  RC_ASSERT(distance(robots.X_WS()[0], X_tilt * X_LS) <= kRounding);
  RC_ASSERT(distance(robots.X_WS()[1], X_pan * X_LS) <= kRounding);
  RC_ASSERT(distance(robots.X_WS()[2], X_LS) <= kRounding);
}

TEST(PanTiltRobots, FollowSelectedRotationsOnly) {
  PanTilt platform;
  platform.drive = {};
  Robots robots(panTilt(platform), 1);
  robots.reset(0, std::vector{0.3, 0.6});
  // z of S is inclined by the tilt angle: w_z is cos(tilt) times the velocity of the pan joint. The other coordinates are not selected.
  const Twist twist{{1, 2, 3}, {4, 0.2, 0.5}};
  robots.command(std::vector{twist}, kTick);
  EXPECT_NEAR(robots.jointVelocities()[0], 0.5 / std::cos(0.6), kRounding);
  EXPECT_NEAR(robots.jointVelocities()[1], 0.2, kRounding);
  EXPECT_EQ(robots.status()[0], 0);
}

// The paper's proportional controller on the pan axis, w_z = -gain error, and its settling time to 2 % of the initial error.
struct Settling {
  double time;   // s, after which the error stays within 2 %
  double error;  // rad, at the end
};
Settling simulateServo(const Manipulator& platform, double gain, double start) {
  Robots robots(platform, 1);
  robots.reset(0, std::vector{start, 0.0});
  Settling result{0, 0};
  constexpr int kTicks = 1500;
  for (int n = 0; n < kTicks; ++n) {
    const double error = robots.jointPositions()[0];
    robots.command(std::vector{Twist{{0, 0, 0}, {0, 0, -gain * error}}}, kTick);
    if (std::abs(robots.jointPositions()[0]) > 0.02 * std::abs(start)) result.time = (n + 2) * kTick;
  }
  result.error = robots.jointPositions()[0];
  return result;
}

TEST(PanTiltRobots, SettleInTheFiveSecondsOfThePaper) {
  constexpr double kGain = 0.7824;  // 3.912 / 5 s
  const double start = 45 * kPi / 180, step = 0.29 * kPi / 180;
  PanTilt exact;
  exact.drive = {};
  // e_n = (1 - gain Ts)^n e_0, so the settling time is ln(0.02) / ln(1 - gain Ts) = 498 ticks.
  EXPECT_NEAR(simulateServo(panTilt(exact), kGain, start).time, 4.98, 1.5 * kTick);
  // A quantized joint is within half a step of its command. At the rate gain 0.02 e_0 that is step / (2 gain 0.02 e_0) = 0.21 s.
  const Settling stepped = simulateServo(panTilt({}), kGain, start);
  EXPECT_NEAR(stepped.time, 4.98, step / (2 * kGain * 0.02 * start) + 1.5 * kTick);
}

// Below 18.5 deg an increment of the command, gain Ts error, is less than half a step. If the rounded joint position were integrated
// instead of the command, the controller would stall there.
TEST(PanTiltRobots, IncrementsBelowAPositionStepAccumulate) {
  constexpr double kGain = 0.7824;
  const double start = 18 * kPi / 180, step = 0.29 * kPi / 180;
  ASSERT_LT(kGain * kTick * start, step / 2);
  EXPECT_LE(std::abs(simulateServo(panTilt({}), kGain, start).error), step / 2 + kRounding);
}

TEST(PanTiltRobots, JointPositionsAreMultiplesOfTheStepWithinTheLimits) {
  const double step = 0.29 * kPi / 180;
  PanTilt platform;
  platform.position_limits = {-517.6 * step, 517.6 * step};
  Robots robots(panTilt(platform), 1);
  for (int n = 0; n < 60; ++n) {
    robots.command(std::vector{Twist{{0, 0, 0}, {0, 0, 5}}}, kTick);
    const double steps = robots.jointPositions()[0] / step;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
  }
  // The multiple nearest to the limit, 518, is beyond it.
  EXPECT_NEAR(robots.jointPositions()[0], 517 * step, kRounding);
  EXPECT_EQ(robots.status()[0], kJointLimit);
  robots.command(std::vector{Twist{{0, 0, 0}, {0, 0, -5}}}, kTick);
  EXPECT_EQ(robots.status()[0], 0);
  EXPECT_LT(robots.jointPositions()[0], 509 * step);  // 0.05 rad are 9.9 steps
}

TEST(PanTiltRobots, JointsFollowCommandsAfterTheDelay) {
  PanTilt platform;
  platform.drive = {.position_step = 0, .delay = 3};
  Robots delayed(panTilt(platform), 2);
  platform.drive.delay = 0;
  Robots undelayed(panTilt(platform), 2);
  std::vector<double> history(3, 0.0);
  for (int n = 0; n < 20; ++n) {
    const Twist twist{{0, 0, 0}, {0, 0, std::sin(0.5 * n)}};
    // The second instance is reset in between, which clears its delayed commands.
    if (n == 7) delayed.reset(1);
    delayed.command(std::vector{twist, n < 7 ? twist : Twist{}}, kTick);
    undelayed.command(std::vector{twist, twist}, kTick);
    history.push_back(undelayed.jointPositions()[0]);
    EXPECT_NEAR(delayed.jointPositions()[0], history[n], kRounding) << n;
    if (n >= 7) {
      EXPECT_EQ(delayed.jointPositions()[2], 0) << n;
    }
  }
}

TEST(PanTiltRobots, RespectTheVelocityLimit) {
  PanTilt platform;
  platform.drive = {};
  Robots robots(panTilt(platform), 1);
  // 20 rad/s exceed the limit by a factor of 20 / 6.178. Both joints are scaled by it.
  robots.command(std::vector{Twist{{0, 0, 0}, {0, 10, 20}}}, kTick);
  EXPECT_NEAR(robots.jointVelocities()[0], 59 * 2 * kPi / 60, kRounding * 100);
  EXPECT_NEAR(robots.jointVelocities()[1], 59 * kPi / 60, kRounding * 100);
  EXPECT_EQ(robots.status()[0], kVelocityLimit);
}

}  // namespace
}  // namespace taxelsim
