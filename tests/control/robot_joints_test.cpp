// Robots commanded by joint velocities.
#include "example_robots.h"
#include "support/test.h"

namespace taxelsim {
namespace {

const std::vector<std::uint8_t> kByJoints{1};
const std::vector<Twist> kNoTwist(1);

// The velocities that a twist gives, given directly, lead to the same posture and the same twist.
TEST(RobotJoints, FollowVelocitiesAsTheTwistThatTheyGive) {
  Robots by_twist(lwr(), 1), by_joints(lwr(), 1);
  const Twist twist{{0.01, -0.02, 0.03}, {0.1, -0.05, 0.02}};
  for (int n = 0; n < 20; ++n) {
    by_twist.command(std::vector{twist}, kTick);
    const std::span<const double> velocities = by_twist.jointVelocities();
    const Twist given = by_joints.twistOf(0, velocities);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(given.v[k], twist.v[k], 1e-9);
      EXPECT_NEAR(given.w[k], twist.w[k], 1e-9);
    }
    by_joints.command(kNoTwist, velocities, kByJoints, kTick);
    for (std::size_t j = 0; j < velocities.size(); ++j) EXPECT_NEAR(by_joints.jointPositions()[j], by_twist.jointPositions()[j], kRounding);
    EXPECT_EQ(by_joints.status()[0], 0);
  }
}

TEST(RobotJoints, KeepTheirLimits) {
  Manipulator robot = lwr();
  robot.drive = {};
  Robots robots(robot, 1);
  std::vector<double> velocities(robot.joints.size(), 0.0);
  // Twice the velocity limit of joint 0: all velocities are halved.
  velocities[0] = 2 * robot.joints[0].max_velocity;
  velocities[2] = 0.1;
  robots.command(kNoTwist, velocities, kByJoints, kTick);
  EXPECT_EQ(robots.status()[0], kVelocityLimit);
  EXPECT_NEAR(robots.jointVelocities()[0], robot.joints[0].max_velocity, 1e-9);
  EXPECT_NEAR(robots.jointVelocities()[2], 0.05, 1e-9);
  // Up to the position limit of joint 3, and no further.
  velocities.assign(velocities.size(), 0.0);
  velocities[3] = robot.joints[3].max_velocity;
  for (int n = 0; n < 1000; ++n) robots.command(kNoTwist, velocities, kByJoints, kTick);
  EXPECT_EQ(robots.status()[0], kJointLimit);
  EXPECT_NEAR(robots.jointPositions()[3], robot.joints[3].upper, 1e-12);
  EXPECT_NEAR(robots.jointVelocities()[3], 0, 1e-9);
}

TEST(RobotJoints, DoNotMoveForVelocitiesThatAreNotFinite) {
  Robots robots(lwr(), 1);
  std::vector<double> velocities(7, 0.1);
  velocities[5] = kNan;
  const std::vector<double> before(robots.jointPositions().begin(), robots.jointPositions().end());
  robots.command(kNoTwist, velocities, kByJoints, kTick);
  EXPECT_EQ(robots.status()[0], kLost);
  EXPECT_EQ(before, std::vector<double>(robots.jointPositions().begin(), robots.jointPositions().end()));
}

// Six of seven joints give the twist; the seventh rests.
TEST(RobotJoints, APartOfThemFollowsATwistOfAnySensor) {
  Manipulator robot = lwr();
  robot.sensors.push_back(robot.sensors[0]);
  robot.sensors[1].X_JS = robot.sensors[1].X_JS * Pose{{0.02, -0.03, 0.05}, axisAngle({0, 1, 0}, 0.4)};
  const Robots robots(robot, 2);
  const Twist twist{{0.01, -0.02, 0.03}, {0.1, -0.05, 0.02}};
  std::vector<std::uint8_t> follows(7, 1);
  follows[2] = 0;
  for (const int sensor : {0, 1}) {
    std::vector<double> velocities(7, kNan);
    EXPECT_EQ(robots.solve(1, sensor, twist, follows, kTick, velocities), 0);
    EXPECT_EQ(velocities[2], 0);
    const Twist found = robots.twistOf(1, sensor, velocities);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(found.v[k], twist.v[k], kRounding);
      EXPECT_NEAR(found.w[k], twist.w[k], kRounding);
    }
  }
}

TEST(RobotJoints, APartOfThemKeepsItsLimits) {
  Manipulator robot = lwr();
  robot.joints[5].upper = robot.joints[5].initial_position + 1e-4;
  const Robots robots(robot, 1);
  const std::vector<std::uint8_t> follows{1, 1, 0, 1, 1, 1, 1};
  const Twist twist{{0.01, -0.02, 0.03}, {0.1, -0.05, 0.02}};
  std::vector<double> slow(7), fast(7);
  ASSERT_EQ(robots.solve(0, 0, twist, follows, 1e-6, slow), 0);
  // The direction of the twist is kept at the velocity limit.
  EXPECT_EQ(robots.solve(0, 0, scaled(twist, 1000), follows, 1e-6, fast), kVelocityLimit);
  double largest = 0;
  for (std::size_t j = 0; j < 7; ++j) largest = std::max(largest, std::abs(fast[j]) / robot.joints[j].max_velocity);
  EXPECT_NEAR(largest, 1, kRounding);
  for (std::size_t j = 0; j < 7; ++j) EXPECT_NEAR(fast[j] * slow[1], slow[j] * fast[1], kRounding);
  // No joint passes its position limit; the joint that rests stays at rest.
  const Twist upwards = scaled(twist, slow[5] > 0 ? 1 : -1);
  EXPECT_EQ(robots.solve(0, 0, upwards, follows, kTick, slow), kJointLimit);
  EXPECT_NEAR(slow[5] * kTick, 1e-4, kRounding);
  EXPECT_EQ(slow[2], 0);
  EXPECT_EQ(robots.solve(0, 0, {{kNan, 0, 0}, {}}, follows, kTick, slow), kLost);
  EXPECT_EQ(slow, std::vector<double>(7, 0.0));
}

}  // namespace
}  // namespace taxelsim
