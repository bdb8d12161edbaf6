// Free-flying robots, and bitwise independence of instances in a batch.
#include "control/robots.h"

#include "control/twist.h"
#include "example_robots.h"
#include "random_robots.h"
#include "support/test.h"

namespace taxelsim {
namespace {

TEST(FreeFlyingRobots, MoveAtTheirTwists) {
  Robots robots(FreeFlying{}, 2);
  EXPECT_EQ(robots.numJoints(), 0);
  EXPECT_EQ(robots.numSensors(), 1);
  const Pose start{{1, 2, 3}, axisAngle({1, 1, 0}, 0.4)};
  robots.reset(1, start);
  const std::vector<Twist> twists{{{0.1, 0, 0}, {0, 0, 1}}, {{0, 0.2, 0}, {0.5, 0, 0}}};
  robots.command(twists, kTick);
  EXPECT_EQ(robots.X_WS()[0], integrate(Pose{}, twists[0], kTick));
  EXPECT_EQ(robots.X_WS()[1], integrate(start, twists[1], kTick));
  robots.reset(1);
  EXPECT_EQ(robots.X_WS()[1], Pose{});
  EXPECT_EQ(robots.status()[1], 0);
}

TEST(FreeFlyingRobots, StopForTwistsThatAreNotFinite) {
  Robots robots(FreeFlying{}, 1);
  for (const Twist& bad : {Twist{{kNan, 0, 0}, {0, 0, 0}}, Twist{{0, 0, 0}, {0, INFINITY, 0}}, Twist{{1e308, 0, 0}, {0, 0, 1e308}}}) {
    robots.command(std::vector{bad}, 10);
    EXPECT_EQ(robots.X_WS()[0], Pose{});
    EXPECT_EQ(robots.status()[0], kLost);
  }
  robots.command(std::vector{Twist{{1, 0, 0}, {0, 0, 0}}}, kTick);
  EXPECT_EQ(robots.status()[0], 0);
  EXPECT_NEAR(robots.X_WS()[0].position[0], kTick, kRounding);
}

// A random twist; in some cases not finite.
Twist drawTwist() {
  Twist twist{drawVector(1), drawVector(2)};
  const int kind = *rc::gen::inRange(0, 8);
  if (kind == 0) twist.v[1] = kNan;
  if (kind == 1) twist.w[2] = INFINITY;
  if (kind == 2) twist.v[0] = 1e308;
  return twist;
}

// Instance i of a batch is bitwise equal to the same instance simulated alone.
void expectIndependentInstances(const Robot& robot) {
  const int num_instances = *rc::gen::inRange(1, 9);
  const int num_ticks = *rc::gen::inRange(1, 30);
  std::vector<std::vector<Twist>> twists(num_ticks, std::vector<Twist>(num_instances));
  for (std::vector<Twist>& tick : twists) {
    for (Twist& twist : tick) twist = drawTwist();
  }
  Robots batch(robot, num_instances);
  for (const std::vector<Twist>& tick : twists) batch.command(tick, kTick);
  const int n = batch.numJoints(), s = batch.numSensors();
  for (int i = 0; i < num_instances; ++i) {
    Robots alone(robot, 1);
    for (const std::vector<Twist>& tick : twists) alone.command(std::span(&tick[i], 1), kTick);
    for (int k = 0; k < s; ++k) RC_ASSERT(alone.X_WS()[k] == batch.X_WS()[i * s + k]);
    for (int j = 0; j < n; ++j) RC_ASSERT(alone.jointPositions()[j] == batch.jointPositions()[i * n + j]);
    for (int j = 0; j < n; ++j) RC_ASSERT(alone.jointVelocities()[j] == batch.jointVelocities()[i * n + j]);
    RC_ASSERT(alone.status()[0] == batch.status()[i]);
    const bool is_invalid = (alone.status()[0] & kLost) != 0;
    const Twist& last = twists.back()[i];
    if (!std::isfinite(last.v[1]) || !std::isfinite(last.w[2])) RC_ASSERT(is_invalid);
    for (const double q : alone.jointPositions()) RC_ASSERT(std::isfinite(q));
  }
}

RC_GTEST_PROP(RobotBatch, FreeFlyingInstancesAreIndependent, ()) {
  expectIndependentInstances(FreeFlying{});
}

RC_GTEST_PROP(RobotBatch, PanTiltInstancesAreIndependent, ()) {
  expectIndependentInstances(panTilt({.drive = {.position_step = 0.005, .delay = *rc::gen::inRange(0, 4)}}));
}

RC_GTEST_PROP(RobotBatch, ManipulatorInstancesAreIndependent, ()) {
  static const Manipulator robot = lwr();
  expectIndependentInstances(*rc::gen::arbitrary<bool>() ? robot : drawManipulator(*rc::gen::inRange(1, 9), 0.5));
}

}  // namespace
}  // namespace taxelsim
