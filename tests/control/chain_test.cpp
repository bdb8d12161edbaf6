#include "control/chain.h"

#include "random_robots.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kRounding = 1e-13;  // a few hundred rounding errors of numbers of order 1

// Forward kinematics with the public operators of Pose.
Pose referencePose(const MountedSensor& sensor, const std::vector<double>& q) {
  Pose X;
  for (const ChainJoint& joint : sensor.chain) {
    const double position = joint.multiplier * q[joint.joint] + joint.offset;
    const bool is_revolute = joint.type == JointType::kRevolute;
    X = X * joint.X_PJ * (is_revolute ? Pose{{0, 0, 0}, axisAngle({0, 0, 1}, position)} : Pose{{0, 0, position}, {1, 0, 0, 0}});
  }
  return X * sensor.X_JS;
}

std::vector<double> drawPositions(int num_joints) {
  std::vector<double> q(num_joints);
  for (double& position : q) position = drawBetween(-2, 2);
  return q;
}

RC_GTEST_PROP(Chain, PoseIsTheProductOfJointPoses, ()) {
  const int num_joints = *rc::gen::inRange(1, 9);
  const Manipulator robot = drawManipulator(num_joints, 0.5);
  const std::vector<double> q = drawPositions(num_joints);
  const Chain chain(robot.sensors[0], num_joints);
  RC_ASSERT(distance(chain.poseAt(q.data()), referencePose(robot.sensors[0], q)) <= 10 * kRounding);
  std::vector<double> jacobian(6 * q.size());
  RC_ASSERT(chain.poseAt(q.data(), jacobian.data()) == chain.poseAt(q.data()));
}

RC_GTEST_PROP(Chain, JacobianMatchesFiniteDifferences, ()) {
  const int num_joints = *rc::gen::inRange(1, 9);
  const Manipulator robot = drawManipulator(num_joints, 0.5);
  const std::vector<double> q = drawPositions(num_joints);
  const Chain chain(robot.sensors[0], num_joints);
  std::vector<double> jacobian(6 * q.size());
  const Pose X = chain.poseAt(q.data(), jacobian.data());
  // A column is a sum over at most five joints with multipliers up to 2, with lever arms of at most 12 links of 0.87 m and translations of
  // 5 m. Third derivatives are below 9^3 * 70 = 5e4, times h^2 / 6 = 8e-7 at h = 1e-5. Rounding: 1e-14 / h = 1e-9.
  constexpr double kH = 1e-5, kDifference = 1e-6;
  for (int j = 0; j < num_joints; ++j) {
    std::vector<double> low = q, high = q;
    low[j] -= kH, high[j] += kH;
    const Pose before = chain.poseAt(low.data()), after = chain.poseAt(high.data());
    const Vector3 v = rotate(inverse(X).rotation, scale(1 / (2 * kH), subtract(after.position, before.position)));
    const Quaternion rotation = inverse(before).rotation * after.rotation;
    const Vector3 w = scale(std::copysign(1, rotation[0]) / kH, {rotation[1], rotation[2], rotation[3]});
    const double* const row = &jacobian[6 * static_cast<std::size_t>(j)];
    RC_ASSERT(distance(v, Vector3{row[0], row[1], row[2]}) <= kDifference);
    RC_ASSERT(distance(w, Vector3{row[3], row[4], row[5]}) <= kDifference);
  }
}

TEST(Chain, WithoutJointsHasAConstantPose) {
  const Pose X_BS{{1, 2, 3}, axisAngle({1, 0, 0}, 0.3)};
  const Chain chain({.link = "base", .chain = {}, .X_JS = X_BS}, 1);
  const double q = 0.7;
  double jacobian[6] = {1, 1, 1, 1, 1, 1};
  EXPECT_LE(distance(chain.poseAt(&q, jacobian), X_BS), kRounding);
  for (const double entry : jacobian) EXPECT_EQ(entry, 0);
}

// Quaternions are continuous where a rotation passes 180 degrees.
TEST(Chain, QuaternionsAreContinuous) {
  const Chain chain({.link = "tip", .chain = {{.X_PJ = {}}, {.X_PJ = {{0, 0, 0}, axisAngle({1, 0, 0}, 1.5)}}}, .X_JS = {}}, 1);
  double q = -4;
  Quaternion last = chain.poseAt(&q).rotation;
  constexpr double kStep = 1e-3;
  for (; q < 4; q += kStep) {
    const Quaternion next = chain.poseAt(&q).rotation;
    for (int i = 0; i < 4; ++i) ASSERT_NEAR(next[i], last[i], 2 * kStep) << q;
    last = next;
  }
}

}  // namespace
}  // namespace taxelsim
