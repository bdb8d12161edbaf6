#include "control/chain.h"

#include <algorithm>
#include <array>

#include "base/quaternion.h"
#include "base/sin_cos.h"
#include "base/vector3.h"

namespace taxelsim {
namespace {

// q times a rotation about z, given by sine and cosine of half its angle; not normalised.
Quaternion rotateAboutZ(const Quaternion& q, const SinCos& half) {
  const auto [sine, cosine] = half;
  return {q[0] * cosine - q[3] * sine, q[1] * cosine + q[2] * sine, q[2] * cosine - q[1] * sine, q[3] * cosine + q[0] * sine};
}

Vector3 zAxisOf(const Quaternion& q) {
  return {2 * (q[1] * q[3] + q[0] * q[2]), 2 * (q[2] * q[3] - q[0] * q[1]), 1 - 2 * (q[1] * q[1] + q[2] * q[2])};
}

// The vector rotated by a unit quaternion; cheaper than rotate(), which forms the matrix.
Vector3 rotateVector(const Quaternion& q, const Vector3& v) {
  const Vector3 u{q[1], q[2], q[3]};
  const Vector3 t = scale(2, cross(u, v));
  return add(v, add(scale(q[0], t), cross(u, t)));
}

// A joint's axis in B: direction and a point on it.
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
    X.position = add(X.position, rotateVector(X.rotation, joint.X_PJ.position));
    X.rotation = product(X.rotation, joint.X_PJ.rotation);
    axes[k] = {zAxisOf(X.rotation), X.position};
    const double position = joint.multiplier * q[joint.joint] + joint.offset;
    if (joint.type == JointType::kRevolute) {
      X.rotation = rotateAboutZ(X.rotation, sinCos(position / 2));
    } else {
      X.position = add(X.position, scale(position, axes[k].direction));
    }
  }
  X.position = add(X.position, rotateVector(X.rotation, X_JS_.position));
  X.rotation = X.rotation * X_JS_.rotation;  // normalises
  if (jacobian == nullptr) return X;

  std::fill_n(jacobian, 6 * num_joints_, 0.0);
  const std::array<double, 9> R = rotationMatrix(X.rotation);
  const auto addInSensorFrame = [&](const Vector3& v, double factor, double* out) {
    for (int i = 0; i < 3; ++i) out[i] += factor * (R[i] * v[0] + R[3 + i] * v[1] + R[6 + i] * v[2]);
  };
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const ChainJoint& joint = joints_[k];
    double* const row = jacobian + 6 * static_cast<std::ptrdiff_t>(joint.joint);
    if (joint.type == JointType::kRevolute) {
      addInSensorFrame(cross(axes[k].direction, subtract(X.position, axes[k].point)), joint.multiplier, row);
      addInSensorFrame(axes[k].direction, joint.multiplier, row + 3);
    } else {
      addInSensorFrame(axes[k].direction, joint.multiplier, row);
    }
  }
  return X;
}

}  // namespace taxelsim
