#include "control/chain.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/vector3.h"

namespace taxelsim {
namespace {

// Without the normalisation that Pose has: that is done once at the end of a chain.
Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],  //
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],  //
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],  //
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

// q times a turn about z, given by sine and cosine of half its angle.
Quaternion turnedAboutZ(const Quaternion& q, double sine, double cosine) {
  return {q[0] * cosine - q[3] * sine, q[1] * cosine + q[2] * sine, q[2] * cosine - q[1] * sine, q[3] * cosine + q[0] * sine};
}

Vector3 zAxisOf(const Quaternion& q) {
  return {2 * (q[1] * q[3] + q[0] * q[2]), 2 * (q[2] * q[3] - q[0] * q[1]), 1 - 2 * (q[1] * q[1] + q[2] * q[2])};
}

Vector3 rotated(const Quaternion& q, const Vector3& v) {
  const Vector3 u{q[1], q[2], q[3]};
  const Vector3 t = scale(2, cross(u, v));
  return add(v, add(scale(q[0], t), cross(u, t)));
}

// A joint's axis and a point on it, in B.
struct Axis {
  Vector3 direction;
  Vector3 point;
};

}  // namespace

Chain::Chain(const MountedSensor& sensor, int num_joints) : joints_(sensor.chain), X_JS_(sensor.X_JS), num_joints_(num_joints) {}

Pose Chain::poseAt(const double* q) const {
  return poseAt(q, nullptr);
}

Pose Chain::poseAt(const double* q, double* jacobian) const {
  std::array<Axis, kMaxChainJoints> axes;
  Pose X{{0, 0, 0}, {1, 0, 0, 0}};
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const ChainJoint& joint = joints_[k];
    X.position = add(X.position, rotated(X.rotation, joint.X_PJ.position));
    X.rotation = product(X.rotation, joint.X_PJ.rotation);
    axes[k] = {zAxisOf(X.rotation), X.position};
    const double position = joint.multiplier * q[joint.joint] + joint.offset;
    if (joint.type == JointType::kRevolute) {
      X.rotation = turnedAboutZ(X.rotation, std::sin(position / 2), std::cos(position / 2));
    } else {
      X.position = add(X.position, scale(position, axes[k].direction));
    }
  }
  X.position = add(X.position, rotated(X.rotation, X_JS_.position));
  X.rotation = X.rotation * X_JS_.rotation;  // normalised
  if (jacobian == nullptr) return X;

  std::fill_n(jacobian, 6 * num_joints_, 0.0);
  const std::array<double, 9> R = rotationMatrix(X.rotation);
  const auto inSensor = [&](const Vector3& v, double factor, double* out) {
    for (int i = 0; i < 3; ++i) out[i] += factor * (R[i] * v[0] + R[3 + i] * v[1] + R[6 + i] * v[2]);
  };
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const ChainJoint& joint = joints_[k];
    double* const row = jacobian + 6 * static_cast<std::ptrdiff_t>(joint.joint);
    if (joint.type == JointType::kRevolute) {
      inSensor(cross(axes[k].direction, subtract(X.position, axes[k].point)), joint.multiplier, row);
      inSensor(axes[k].direction, joint.multiplier, row + 3);
    } else {
      inSensor(axes[k].direction, joint.multiplier, row);
    }
  }
  return X;
}

}  // namespace taxelsim
