// Random robots and poses for property tests.
#pragma once

#include "base/vector3.h"
#include "support/test.h"
#include "taxelsim/robot.h"

namespace taxelsim {

inline double drawBetween(double min, double max) {
  return min + (max - min) * (*rc::gen::inRange(0, 1 << 30)) / static_cast<double>(1 << 30);
}

inline Vector3 drawVector(double size) {
  return {drawBetween(-size, size), drawBetween(-size, size), drawBetween(-size, size)};
}

inline Quaternion drawRotation() {
  return axisAngle({drawBetween(0.1, 1), drawBetween(-1, 1), drawBetween(-1, 1)}, drawBetween(-3, 3));
}

inline Pose drawPose(double size) {
  return {drawVector(size), drawRotation()};
}

// Largest absolute difference of the coordinates. Quaternions q and -q are equal.
inline double distance(const Pose& a, const Pose& b) {
  double sign = 0, largest = 0;
  for (int i = 0; i < 4; ++i) sign += a.rotation[i] * b.rotation[i];
  for (int i = 0; i < 4; ++i) largest = std::max(largest, std::abs(a.rotation[i] - std::copysign(1, sign) * b.rotation[i]));
  for (int i = 0; i < 3; ++i) largest = std::max(largest, std::abs(a.position[i] - b.position[i]));
  return largest;
}
inline double distance(const Vector3& a, const Vector3& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

// A chain with `num_joints` degrees of freedom and up to four mimic joints. Links are at most `size` m along each axis.
inline Manipulator drawManipulator(int num_joints, double size) {
  Manipulator robot{.name = "random", .joints = {}, .sensors = {}, .X_WB = drawPose(size)};
  MountedSensor sensor{.link = "tip", .chain = {}, .X_JS = drawPose(size)};
  const int length = num_joints + *rc::gen::inRange(0, 5);
  for (int k = 0; k < length; ++k) {
    const auto type = *rc::gen::inRange(0, 4) == 0 ? JointType::kPrismatic : JointType::kRevolute;
    const bool is_mimic = k >= num_joints;
    sensor.chain.push_back({.X_PJ = drawPose(size),
                            .type = type,
                            .joint = is_mimic ? *rc::gen::inRange(0, num_joints) : k,
                            .multiplier = is_mimic ? drawBetween(-2, 2) : 1,
                            .offset = is_mimic ? drawBetween(-1, 1) : 0});
    if (!is_mimic) robot.joints.push_back({.name = "q" + std::to_string(k), .type = type});
  }
  robot.sensors.push_back(std::move(sensor));
  return robot;
}

}  // namespace taxelsim
