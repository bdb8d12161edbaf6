// Batches of robots: what they do in a tick, at their limits and in singular poses, and that nothing of it depends on the neighbours.
#include "control/robots.h"

#include <gtest/gtest.h>
// After gtest.h, whose macros it uses.
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "control/twist.h"
#include "robot_draws.h"
#include "taxelsim/error.h"
#include "urdf_text.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-13;  // some hundreds of roundings on numbers of order 1
constexpr double kTick = 0.01;       // s
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Manipulator lwr() {
  Manipulator robot =
      loadUrdf(kRobots / "lwr_palm.urdf", {.base_link = "", .sensors = {{"palm", {{0, -0.011, 0.045}, axisAngle({1, 0, 0}, kPi / 2)}}}});
  robot.joints[1].initial_position = 0.5;
  robot.joints[3].initial_position = -1.5;
  robot.joints[5].initial_position = 1;
  return robot;
}

Twist scaled(const Twist& twist, double factor) {
  return {scale(factor, twist.v), scale(factor, twist.w)};
}

// The twist that takes one pose to the other in `dt`, to first order in the step.
Twist twistBetween(const Pose& before, const Pose& behind, double dt) {
  const Pose step = inverse(before) * behind;
  const double sign = std::copysign(2 / dt, step.rotation[0]);
  return {scale(1 / dt, step.position), scale(sign, {step.rotation[1], step.rotation[2], step.rotation[3]})};
}

TEST(FreeFlyingRobots, FlyAtTheirTwists) {
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

TEST(FreeFlyingRobots, StandStillWithoutAFiniteTwist) {
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

// Pan turns about z of the base, tilt about y of what pan has turned.
RC_GTEST_PROP(PanTiltRobots, HaveTheClosedFormOfTheirGeometry, ()) {
  const Pose X_LS = drawPose(0.1);
  const Manipulator platform = panTilt({.tilt_height = 0.07, .sensors = {{"tilt", X_LS}, {"pan", X_LS}, {"base", X_LS}}});
  const double pan = 0.29 * kPi / 180 * *rc::gen::inRange(-500, 500), tilt = 0.29 * kPi / 180 * *rc::gen::inRange(-500, 500);
  Robots robots(platform, 1);
  robots.reset(0, std::vector{pan, tilt});
  const Pose turned{{0, 0, 0}, axisAngle({0, 0, 1}, pan)};
  const Pose tilted = turned * Pose{{0, 0, 0.07}, axisAngle({0, 1, 0}, tilt)};
  RC_ASSERT(distance(robots.X_WS()[0], tilted * X_LS) <= kRounding);
  RC_ASSERT(distance(robots.X_WS()[1], turned * X_LS) <= kRounding);
  RC_ASSERT(distance(robots.X_WS()[2], X_LS) <= kRounding);
}

TEST(PanTiltRobots, SelectedTurnsBecomePanAndTilt) {
  PanTilt platform;
  platform.drive = {};
  Robots robots(panTilt(platform), 1);
  robots.reset(0, std::vector{0.3, 0.6});
  // z of S leans by the tilt: pan turns about it at cos(tilt) of its speed. What is not selected is not followed.
  const Twist wanted{{1, 2, 3}, {4, 0.2, 0.5}};
  robots.command(std::vector{wanted}, kTick);
  EXPECT_NEAR(robots.jointVelocities()[0], 0.5 / std::cos(0.6), kRounding);
  EXPECT_NEAR(robots.jointVelocities()[1], 0.2, kRounding);
  EXPECT_EQ(robots.status()[0], 0);
}

// The paper's loop on the pan axis: w_z = -gain times the angle that is left, until it is 2 % of where it began.
struct Convergence {
  double time;   // s, after which the error stays within 2 %
  double error;  // rad, at the end
};
Convergence servo(const Manipulator& platform, double gain, double start) {
  Robots robots(platform, 1);
  robots.reset(0, std::vector{start, 0.0});
  Convergence result{0, 0};
  constexpr int kTicks = 1500;
  for (int n = 0; n < kTicks; ++n) {
    const double error = robots.jointPositions()[0];
    robots.command(std::vector{Twist{{0, 0, 0}, {0, 0, -gain * error}}}, kTick);
    if (std::abs(robots.jointPositions()[0]) > 0.02 * std::abs(start)) result.time = (n + 2) * kTick;
  }
  result.error = robots.jointPositions()[0];
  return result;
}

TEST(PanTiltRobots, ConvergeInFiveSecondsAsThePaperSays) {
  constexpr double kGain = 0.7824;  // 3.912 / 5 s
  const double start = 45 * kPi / 180, step = 0.29 * kPi / 180;
  PanTilt exact;
  exact.drive = {};
  // e_n = (1 - gain Ts)^n e_0: ln(0.02) / ln(1 - gain Ts) = 498 ticks, one more to be within.
  EXPECT_NEAR(servo(panTilt(exact), kGain, start).time, 4.98, 1.5 * kTick);
  // A joint that goes in steps is within half a step of the command: step / (2 gain 0.02 e_0) = 0.21 s sooner or later.
  const Convergence stepped = servo(panTilt({}), kGain, start);
  EXPECT_NEAR(stepped.time, 4.98, step / (2 * kGain * 0.02 * start) + 1.5 * kTick);
}

// Increments of a servo loop are smaller than half a step long before it has arrived: gain Ts error < step / 2 from 18.5 deg on. Were they
// added to the joint instead of the command, it would stall there.
TEST(PanTiltRobots, IncrementsBelowAStepAddUp) {
  constexpr double kGain = 0.7824;
  const double start = 18 * kPi / 180, step = 0.29 * kPi / 180;
  ASSERT_LT(kGain * kTick * start, step / 2);
  EXPECT_LE(std::abs(servo(panTilt({}), kGain, start).error), step / 2 + kRounding);
}

TEST(PanTiltRobots, JointsStandOnStepsWithinTheLimits) {
  const double step = 0.29 * kPi / 180;
  PanTilt platform;
  platform.position_limits = {-517.6 * step, 517.6 * step};
  Robots robots(panTilt(platform), 1);
  for (int n = 0; n < 60; ++n) {
    robots.command(std::vector{Twist{{0, 0, 0}, {0, 0, 5}}}, kTick);
    const double steps = robots.jointPositions()[0] / step;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
  }
  // The step next to the limit is the 518th, which is beyond it.
  EXPECT_NEAR(robots.jointPositions()[0], 517 * step, kRounding);
  EXPECT_EQ(robots.status()[0], kJointLimit);
  robots.command(std::vector{Twist{{0, 0, 0}, {0, 0, -5}}}, kTick);
  EXPECT_EQ(robots.status()[0], 0);
  EXPECT_LT(robots.jointPositions()[0], 509 * step);  // 0.05 rad are 9.9 steps
}

TEST(PanTiltRobots, CommandsArriveAfterTheirDelay) {
  PanTilt platform;
  platform.drive = {.position_step = 0, .delay = 3};
  Robots delayed(panTilt(platform), 2);
  platform.drive.delay = 0;
  Robots prompt(panTilt(platform), 2);
  std::vector<double> history(3, 0.0);
  for (int n = 0; n < 20; ++n) {
    const Twist twist{{0, 0, 0}, {0, 0, std::sin(0.5 * n)}};
    // The second instance begins anew in between: nothing of what was under way is left.
    if (n == 7) delayed.reset(1);
    delayed.command(std::vector{twist, n < 7 ? twist : Twist{}}, kTick);
    prompt.command(std::vector{twist, twist}, kTick);
    history.push_back(prompt.jointPositions()[0]);
    EXPECT_NEAR(delayed.jointPositions()[0], history[n], kRounding) << n;
    if (n >= 7) {
      EXPECT_EQ(delayed.jointPositions()[2], 0) << n;
    }
  }
}

TEST(PanTiltRobots, KeepTheirVelocityLimit) {
  PanTilt platform;
  platform.drive = {};
  Robots robots(panTilt(platform), 1);
  // 10 and 20 rad/s are too fast by 20 / 6.178: both joints are slowed alike.
  robots.command(std::vector{Twist{{0, 0, 0}, {0, 10, 20}}}, kTick);
  EXPECT_NEAR(robots.jointVelocities()[0], 59 * 2 * kPi / 60, kRounding * 100);
  EXPECT_NEAR(robots.jointVelocities()[1], 59 * kPi / 60, kRounding * 100);
  EXPECT_EQ(robots.status()[0], kVelocityLimit);
}

// How far the sensor is from where the exponential says, and how far it may be. In a tick the joints keep their velocities, and the sensor
// leaves the screw by tick^2 / 2 |dJ/dt q'|. Every joint turns every column and its lever, at most `reach`, so |dJ/dt q'| <= S^2 reach with
// S the sum of the joints' speeds; sums over the ticks, of angles (reach 1) as of lengths.
struct Tracking {
  double error, bound;
};
Tracking track(const Manipulator& robot, const Twist& twist, double time, int num_ticks) {
  constexpr double kReach = 1.5;  // m; the arm is 1.18 m from the base to the flange, the sensor 0.29 m beyond
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

TEST(Manipulators, FollowAConstantTwistAsTheExponentialSays) {
  const Twist twist{{0.05, -0.04, 0.06}, {0.1, 0.15, -0.1}};
  const Tracking coarse = track(lwr(), twist, 1, 100), fine = track(lwr(), twist, 1, 1000);
  EXPECT_LE(coarse.error, coarse.bound);
  EXPECT_LE(fine.error, fine.bound);
  EXPECT_LT(coarse.bound, 5e-3);  // what is claimed is not empty
  // Of first order: it vanishes with the tick. Second order is a tick times a speed of 1 rad/s smaller.
  EXPECT_NEAR(coarse.error / fine.error, 10, 10 * 0.02);
}

TEST(Manipulators, ATooFastTwistKeepsItsDirection) {
  const Twist twist{{3, -2, 1}, {0.5, 0, 4}};
  constexpr double kShort = 1e-6;  // s; first order in it, velocities of order 10: 1e-4 relative
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
  const double part = dot(moved.v, twist.v) / dot(twist.v, twist.v);
  EXPECT_GT(part, 0);
  EXPECT_LT(part, 1);
  EXPECT_LE(distance(moved.v, scaled(twist, part).v), 1e-4);
  EXPECT_LE(distance(moved.w, scaled(twist, part).w), 1e-4);
}

// Two joints in a row about the same axis: when the one is at its limit the other one does the work.
Manipulator twin(double limit) {
  Manipulator robot;
  robot.joints = {{.name = "first", .lower = -limit, .upper = limit}, {.name = "second"}};
  robot.selection = {false, false, false, false, false, true};
  robot.sensors = {{.link = "tip", .chain = {{.X_PJ = {}, .joint = 0}, {.X_PJ = {}, .joint = 1}}, .X_JS = {}}};
  return robot;
}

TEST(Manipulators, AJointStopsAtItsLimitAndOthersTakeOver) {
  Robots robots(twin(0.052), 1);
  const Twist turn{{0, 0, 0}, {0, 0, 1}};
  // Each joint turns at 1/2 rad/s and the first has 0.052 rad to go: 10.4 ticks.
  for (int n = 1; n <= 20; ++n) {
    robots.command(std::vector{turn}, kTick);
    EXPECT_NEAR(robots.jointPositions()[0], std::min(0.005 * n, 0.052), kRounding) << n;
    EXPECT_NEAR(robots.jointPositions()[0] + robots.jointPositions()[1], 0.01 * n, kRounding) << n;
    EXPECT_EQ(robots.status()[0], n <= 10 ? 0 : kJointLimit) << n;
  }
  robots.command(std::vector{scaled(turn, -1)}, kTick);  // away from the limit both move again
  EXPECT_NEAR(robots.jointPositions()[0], 0.052 - 0.005, kRounding);
  EXPECT_EQ(robots.status()[0], 0);
}

TEST(Manipulators, WhatIsLeftOfATwistIsSharedOutAtBothLimits) {
  Manipulator robot = twin(0.005);
  for (Joint& joint : robot.joints) joint.max_velocity = 1;
  Robots robots(robot, 1);
  // Each would turn at 2 rad/s and may at 1: half of the twist. In a tick the first can turn at 0.5 before it is at its limit, the second
  // should turn at 1.5 and may at 1: two thirds of all that.
  robots.command(std::vector{Twist{{0, 0, 0}, {0, 0, 4}}}, kTick);
  EXPECT_NEAR(robots.jointVelocities()[0], 1.0 / 3, kRounding);
  EXPECT_NEAR(robots.jointVelocities()[1], 1, kRounding);
  EXPECT_EQ(robots.status()[0], kJointLimit | kVelocityLimit);
}

TEST(Manipulators, NeverPassALimitAndNeverRunTooFast) {
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

// The stretched arm cannot go farther out, nor come in along its own line; it may go sideways.
TEST(Manipulators, AStretchedArmIsSingular) {
  Manipulator robot = lwr();
  for (Joint& joint : robot.joints) joint.initial_position = 0;
  robot.sensors[0].X_JS = robot.sensors[0].X_JS * Pose{{0, 0, 0}, axisAngle({1, 0, 0}, -kPi / 2)};  // z of S along the arm
  Robots robots(robot, 1);
  const Pose before = robots.X_WS()[0];
  for (const double sign : {1.0, -1.0}) {
    robots.command(std::vector{Twist{{0, 0, 0.1 * sign}, {0, 0, 0}}}, kTick);
    EXPECT_EQ(robots.status()[0], kSingular);
    // The lever of the palm, 0.045 + 0.247 + 0.078 m up and 1 to 2 cm aside, leaves a small way: aside / length of 0.1 m/s.
    EXPECT_LE(distance(robots.X_WS()[0], before), 0.1 * kTick * 0.05);
  }
  double fastest = 0;
  for (int j = 0; j < 7; ++j) fastest = std::max(fastest, std::abs(robots.jointVelocities()[j]));
  EXPECT_LE(fastest, 0.1 / (2 * robot.max_damping));
}

// Nearly stretched, the arm is damped and slow; told to come in it bends, faster and faster, until nothing holds it back.
TEST(Manipulators, LeaveTheNeighbourhoodOfASingularPose) {
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

TEST(Manipulators, ResetPlacesTheSensor) {
  Manipulator robot = lwr();
  robot.X_WB = {{1, 0, 0}, axisAngle({0, 0, 1}, 0.5)};
  Robots robots(robot, 2);
  const Pose first = robots.X_WS()[0];
  EXPECT_LE(distance(first, robot.X_WB * Chain(robot.sensors[0], 7).poseAt(robots.jointPositions().data())), kRounding);
  const Pose wanted{{-1, 2, 0.5}, axisAngle({0, 1, 1}, 2)};
  robots.reset(1, wanted);
  EXPECT_LE(distance(robots.X_WS()[1], wanted), kRounding);
  EXPECT_EQ(robots.X_WS()[0], first);
  robots.command(std::vector<Twist>(2, Twist{{0.1, 0, 0}, {0, 0, 0}}), kTick);
  robots.reset(1);
  EXPECT_EQ(robots.X_WS()[1], first);
  EXPECT_EQ(robots.jointVelocities()[7], 0);
  EXPECT_THROW(robots.reset(0, std::vector{0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0}), Error);
  EXPECT_THROW(robots.reset(0, std::vector{0.0, 0.0, 0.0, kNan, 0.0, 0.0, 0.0}), Error);
}

TEST(Manipulators, EverySensorMoves) {
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

// Random twists, some of them not finite, for instances in different states.
Twist drawBadTwist() {
  Twist twist{drawVector(1), drawVector(2)};
  const int kind = *rc::gen::inRange(0, 8);
  if (kind == 0) twist.v[1] = kNan;
  if (kind == 1) twist.w[2] = INFINITY;
  if (kind == 2) twist.v[0] = 1e308;
  return twist;
}

// Instance i in a batch equals instance i alone, to the bit, whatever the others meet.
void expectSameAlone(const Robot& robot) {
  const int num_instances = *rc::gen::inRange(1, 9);
  const int num_ticks = *rc::gen::inRange(1, 30);
  std::vector<std::vector<Twist>> twists(num_ticks, std::vector<Twist>(num_instances));
  for (std::vector<Twist>& tick : twists) {
    for (Twist& twist : tick) twist = drawBadTwist();
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
    const bool is_lost = (alone.status()[0] & kLost) != 0;
    const Twist& last = twists.back()[i];
    if (!std::isfinite(last.v[1]) || !std::isfinite(last.w[2])) RC_ASSERT(is_lost);
    for (const double q : alone.jointPositions()) RC_ASSERT(std::isfinite(q));
  }
}

RC_GTEST_PROP(RobotBatch, FreeFlyingInstancesDoNotKnowEachOther, ()) {
  expectSameAlone(FreeFlying{});
}

RC_GTEST_PROP(RobotBatch, PanTiltInstancesDoNotKnowEachOther, ()) {
  expectSameAlone(panTilt({.drive = {.position_step = 0.005, .delay = *rc::gen::inRange(0, 4)}}));
}

RC_GTEST_PROP(RobotBatch, ManipulatorInstancesDoNotKnowEachOther, ()) {
  static const Manipulator robot = lwr();
  expectSameAlone(*rc::gen::arbitrary<bool>() ? robot : drawManipulator(*rc::gen::inRange(1, 9), 0.5));
}

TEST(BadRobots, AreRefused) {
  const double inf = std::numeric_limits<double>::infinity();
  std::vector<Manipulator> bad(20, lwr());
  int i = 0;
  bad[i++].joints.clear();
  bad[i++].joints.resize(kMaxJoints + 1);
  bad[i++].sensors.clear();
  bad[i++].joints[0].lower = 3;
  bad[i++].joints[0].lower = kNan;
  bad[i++].joints[0].max_velocity = 0;
  bad[i++].joints[0].initial_position = 3;
  bad[i++].joints[0].initial_position = kNan;
  bad[i++].sensors[0].chain[0].joint = 7;
  bad[i++].sensors[0].chain[0].multiplier = inf;
  bad[i++].sensors[0].chain[0].X_PJ.rotation = {1, 1, 0, 0};
  bad[i++].sensors[0].chain.resize(kMaxChainJoints + 1);
  bad[i++].sensors[0].X_JS.position[0] = kNan;
  bad[i++].X_WB.rotation = {0, 0, 0, 0};
  bad[i++].selection.fill(false);
  bad[i++].max_damping = 0;
  bad[i++].singular_threshold = 1.5;
  bad[i++].drive.position_step = -1;
  bad[i++].drive.position_step = kNan;
  bad[i++].drive.delay = -1;
  for (std::size_t k = 0; k < bad.size(); ++k) EXPECT_THROW(Robots(bad[k], 1), Error) << k;
  EXPECT_NO_THROW(Robots(lwr(), 1));
  EXPECT_THROW(panTilt({.tilt_height = kNan}), Error);
  EXPECT_THROW(panTilt({.sensors = {{"roll", {}}}}), Error);
  EXPECT_THROW(panTilt({.position_limits = {0.001, 0.002}}), Error);  // no step of the joint within
  EXPECT_THROW(panTilt({.max_velocity = -1}), Error);
}

}  // namespace
}  // namespace taxelsim
