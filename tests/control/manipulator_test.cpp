// Manipulators: tracking accuracy, limits, singularities, reset.
#include "control/robots.h"

#include "control/twist.h"
#include "example_robots.h"
#include "random_robots.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Mean twist between two poses, to first order in their difference.
Twist twistBetween(const Pose& before, const Pose& after, double dt) {
  const Pose step = inverse(before) * after;
  const double sign = std::copysign(2 / dt, step.rotation[0]);
  return {scale(1 / dt, step.position), scale(sign, {step.rotation[1], step.rotation[2], step.rotation[3]})};
}

// Deviation of the sensor from the exact screw motion, and an upper bound. Joint velocities are constant during a tick, so the deviation
// per tick is at most tick^2 / 2 |dJ/dt q'|. Every joint rotates every column of J and its lever arm (at most `reach`), so |dJ/dt q'| <=
// S^2 reach, where S is the sum of the joint speeds. The bound holds for lengths and angles.
struct Tracking {
  double error, bound;
};
Tracking track(const Manipulator& robot, const Twist& twist, double time, int num_ticks) {
  constexpr double kReach = 1.5;  // m; 1.18 m from the base to the flange, and 0.29 m to the sensor
  Robots robots(robot, 1);
  const Pose start = robots.X_WS()[0];
  const double tick = time / num_ticks;
  Tracking result{0, 0};
  for (int n = 0; n < num_ticks; ++n) {
    robots.command(std::vector{twist}, tick);
    EXPECT_EQ(robots.status()[0], 0);
    double speed = 0;
    for (const double velocity : robots.jointVelocities()) speed += std::abs(velocity);
    result.bound += tick * tick / 2 * speed * speed * kReach;
  }
  result.error = distance(robots.X_WS()[0], integrate(start, twist, time));
  return result;
}

TEST(Manipulators, FollowTheScrewMotionOfAConstantTwist) {
  const Twist twist{{0.05, -0.04, 0.06}, {0.1, 0.15, -0.1}};
  const Tracking coarse = track(lwr(), twist, 1, 100), fine = track(lwr(), twist, 1, 1000);
  EXPECT_LE(coarse.error, coarse.bound);
  EXPECT_LE(fine.error, fine.bound);
  EXPECT_LT(coarse.bound, 5e-3);  // the bound is meaningful
  // First-order convergence: proportional to the tick. Second-order terms are smaller by tick times 1 rad/s.
  EXPECT_NEAR(coarse.error / fine.error, 10, 10 * 0.02);
}

TEST(Manipulators, ScaleATwistAboveTheVelocityLimits) {
  const Twist twist{{3, -2, 1}, {0.5, 0, 4}};
  constexpr double kShort = 1e-6;  // s; truncation error of relative 1e-4 at velocities of order 10
  Robots robots(lwr(), 1);
  const Pose before = robots.X_WS()[0];
  robots.command(std::vector{twist}, kShort);
  EXPECT_EQ(robots.status()[0], kVelocityLimit);
  double fastest = 0;
  const Manipulator robot = lwr();
  for (int j = 0; j < 7; ++j) fastest = std::max(fastest, std::abs(robots.jointVelocities()[j]) / robot.joints[j].max_velocity);
  constexpr double kRelative = 1e-9;  // positions of order 1 are rounded to 1e-16, over 1e-6 s
  EXPECT_NEAR(fastest, 1, kRelative);
  const Twist moved = twistBetween(before, robots.X_WS()[0], kShort);
  const double factor = dot(moved.v, twist.v) / dot(twist.v, twist.v);
  EXPECT_GT(factor, 0);
  EXPECT_LT(factor, 1);
  EXPECT_LE(distance(moved.v, scaled(twist, factor).v), 1e-4);
  EXPECT_LE(distance(moved.w, scaled(twist, factor).w), 1e-4);
}

// Two joints about the same axis, the first with a limit: the second takes over at the limit.
Manipulator coaxialJoints(double limit) {
  Manipulator robot;
  robot.joints = {{.name = "first", .lower = -limit, .upper = limit}, {.name = "second"}};
  robot.selection = {false, false, false, false, false, true};
  robot.sensors = {{.link = "tip", .chain = {{.X_PJ = {}, .joint = 0}, {.X_PJ = {}, .joint = 1}}, .X_JS = {}}};
  return robot;
}

TEST(Manipulators, OtherJointsTakeOverAtAJointLimit) {
  Robots robots(coaxialJoints(0.052), 1);
  const Twist rotation{{0, 0, 0}, {0, 0, 1}};
  // Each joint rotates at 1/2 rad/s. The first reaches its limit of 0.052 rad after 10.4 ticks.
  for (int n = 1; n <= 20; ++n) {
    robots.command(std::vector{rotation}, kTick);
    EXPECT_NEAR(robots.jointPositions()[0], std::min(0.005 * n, 0.052), kRounding) << n;
    EXPECT_NEAR(robots.jointPositions()[0] + robots.jointPositions()[1], 0.01 * n, kRounding) << n;
    EXPECT_EQ(robots.status()[0], n <= 10 ? 0 : kJointLimit) << n;
  }
  robots.command(std::vector{scaled(rotation, -1)}, kTick);  // away from the limit, both move again
  EXPECT_NEAR(robots.jointPositions()[0], 0.052 - 0.005, kRounding);
  EXPECT_EQ(robots.status()[0], 0);
}

TEST(Manipulators, PositionAndVelocityLimitsCombine) {
  Manipulator robot = coaxialJoints(0.005);
  for (Joint& joint : robot.joints) joint.max_velocity = 1;
  Robots robots(robot, 1);
  // Each joint would need 2 rad/s and is limited to 1: half of the twist. The first reaches its position limit at 0.5 rad/s, so the second
  // would need 1.5 rad/s and is limited to 1: everything is scaled by two thirds.
  robots.command(std::vector{Twist{{0, 0, 0}, {0, 0, 4}}}, kTick);
  EXPECT_NEAR(robots.jointVelocities()[0], 1.0 / 3, kRounding);
  EXPECT_NEAR(robots.jointVelocities()[1], 1, kRounding);
  EXPECT_EQ(robots.status()[0], kJointLimit | kVelocityLimit);
}

TEST(Manipulators, RespectAllLimits) {
  const Manipulator robot = lwr();
  Robots robots(robot, 1);
  const Twist twist{{0.4, 0.1, -0.3}, {0.2, 1, 0.3}};
  bool any_limit = false;
  for (int n = 0; n < 2000; ++n) {
    robots.command(std::vector{n < 1000 ? twist : scaled(twist, -1)}, kTick);
    any_limit = any_limit || (robots.status()[0] & kJointLimit) != 0;
    for (int j = 0; j < 7; ++j) {
      ASSERT_GE(robots.jointPositions()[j], robot.joints[j].lower);
      ASSERT_LE(robots.jointPositions()[j], robot.joints[j].upper);
      ASSERT_LE(std::abs(robots.jointVelocities()[j]), robot.joints[j].max_velocity * (1 + 1e-12));
    }
    ASSERT_EQ(robots.status()[0] & kLost, 0);
  }
  EXPECT_TRUE(any_limit);
}

// A stretched arm cannot move along its own axis.
TEST(Manipulators, AreDampedWhenStretched) {
  Manipulator robot = lwr();
  for (Joint& joint : robot.joints) joint.initial_position = 0;
  robot.sensors[0].X_JS = robot.sensors[0].X_JS * Pose{{0, 0, 0}, axisAngle({1, 0, 0}, -kPi / 2)};  // z of S along the arm
  Robots robots(robot, 1);
  const Pose before = robots.X_WS()[0];
  for (const double sign : {1.0, -1.0}) {
    robots.command(std::vector{Twist{{0, 0, 0.1 * sign}, {0, 0, 0}}}, kTick);
    EXPECT_EQ(robots.status()[0], kSingular);
    // The palm is 1 to 2 cm off the axis at a distance of 0.37 m (0.045 + 0.247 + 0.078), which leaves a motion of offset / distance
    // of 0.1 m/s.
    EXPECT_LE(distance(robots.X_WS()[0], before), 0.1 * kTick * 0.05);
  }
  double fastest = 0;
  for (int j = 0; j < 7; ++j) fastest = std::max(fastest, std::abs(robots.jointVelocities()[j]));
  EXPECT_LE(fastest, 0.1 / (2 * robot.max_damping));
}

// A nearly stretched arm is damped. Commanded inwards, it bends until no damping is applied any more.
TEST(Manipulators, LeaveASingularity) {
  Manipulator robot = lwr();
  robot.joints[3].initial_position = -0.05;
  Robots robots(robot, 1);
  const Pose X_BS = robots.X_WS()[0];
  const Vector3 inwards_B = unit(subtract({0, 0, 0.3105}, X_BS.position));
  int num_singular = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vector3 inwards = rotate(inverse(robots.X_WS()[0]).rotation, inwards_B);
    robots.command(std::vector{Twist{scale(0.05, inwards), {0, 0, 0}}}, kTick);
    if (robots.status()[0] == 0) break;
    EXPECT_EQ(robots.status()[0], kSingular);
    ++num_singular;
  }
  EXPECT_GT(num_singular, 0);
  EXPECT_EQ(robots.status()[0], 0);
  EXPECT_LT(robots.jointPositions()[3], -0.05);
}

TEST(Manipulators, ResetPlacesTheFirstSensor) {
  Manipulator robot = lwr();
  robot.X_WB = {{1, 0, 0}, axisAngle({0, 0, 1}, 0.5)};
  Robots robots(robot, 2);
  const Pose first = robots.X_WS()[0];
  EXPECT_LE(distance(first, robot.X_WB * Chain(robot.sensors[0], 7).poseAt(robots.jointPositions().data())), kRounding);
  const Pose target{{-1, 2, 0.5}, axisAngle({0, 1, 1}, 2)};
  robots.reset(1, target);
  EXPECT_LE(distance(robots.X_WS()[1], target), kRounding);
  EXPECT_EQ(robots.X_WS()[0], first);
  robots.command(std::vector<Twist>(2, Twist{{0.1, 0, 0}, {0, 0, 0}}), kTick);
  robots.reset(1);
  EXPECT_EQ(robots.X_WS()[1], first);
  EXPECT_EQ(robots.jointVelocities()[7], 0);
  EXPECT_THROW(robots.reset(0, std::vector{0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0}), Error);
  EXPECT_THROW(robots.reset(0, std::vector{0.0, 0.0, 0.0, kNan, 0.0, 0.0, 0.0}), Error);
}

TEST(Manipulators, UpdateAllSensors) {
  Manipulator robot = lwr();
  robot.sensors.push_back(robot.sensors[0]);
  robot.sensors[1].X_JS = robot.sensors[1].X_JS * Pose{{0.01, 0, 0}, {1, 0, 0, 0}};
  Robots robots(robot, 2);
  robots.command(std::vector<Twist>(2, Twist{{0.1, 0, 0}, {0, 1, 0}}), kTick);
  ASSERT_EQ(robots.X_WS().size(), 4u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_LE(distance(robots.X_WS()[2 * i + 1], robots.X_WS()[2 * i] * Pose{{0.01, 0, 0}, {1, 0, 0, 0}}), kRounding);
  }
}

}  // namespace
}  // namespace taxelsim
