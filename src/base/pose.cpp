#include "taxelsim/pose.h"

#include <cmath>

#include "base/quaternion.h"
#include "base/vector3.h"

namespace taxelsim {
namespace {

Quaternion normalized(const Quaternion& q) {
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return {q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm};
}

}  // namespace

Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return normalized(product(a, b));
}

std::array<double, 9> rotationMatrix(const Quaternion& q) {
  const auto [w, x, y, z] = q;
  return {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),  //
          2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),  //
          2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
}

Vector3 rotate(const Quaternion& R_AB, const Vector3& v_B) {
  const std::array<double, 9> m = rotationMatrix(R_AB);
  return {m[0] * v_B[0] + m[1] * v_B[1] + m[2] * v_B[2], m[3] * v_B[0] + m[4] * v_B[1] + m[5] * v_B[2],
          m[6] * v_B[0] + m[7] * v_B[1] + m[8] * v_B[2]};
}

Vector3 operator*(const Pose& X_AB, const Vector3& p_B) {
  return add(X_AB.position, rotate(X_AB.rotation, p_B));
}

Pose operator*(const Pose& X_AB, const Pose& X_BC) {
  return {X_AB * X_BC.position, X_AB.rotation * X_BC.rotation};
}

Pose inverse(const Pose& X_AB) {
  const Quaternion R_BA = conjugate(X_AB.rotation);
  const Vector3 p = rotate(R_BA, X_AB.position);
  return {{-p[0], -p[1], -p[2]}, R_BA};
}

Quaternion axisAngle(const Vector3& axis, double angle) {
  const double factor = std::sin(angle / 2) / length(axis);
  return {std::cos(angle / 2), axis[0] * factor, axis[1] * factor, axis[2] * factor};
}

}  // namespace taxelsim
