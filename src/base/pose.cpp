#include "taxelsim/pose.h"

#include <cmath>

namespace taxelsim {
namespace {

Quaternion normalised(const Quaternion& q) {
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return {q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm};
}

}  // namespace

Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return normalised({a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],  //
                     a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],  //
                     a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],  //
                     a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]});
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
  const Vector3 turned = rotate(X_AB.rotation, p_B);
  return {X_AB.position[0] + turned[0], X_AB.position[1] + turned[1], X_AB.position[2] + turned[2]};
}

Pose operator*(const Pose& X_AB, const Pose& X_BC) {
  return {X_AB * X_BC.position, X_AB.rotation * X_BC.rotation};
}

Pose inverse(const Pose& X_AB) {
  const auto [w, x, y, z] = X_AB.rotation;
  const Quaternion R_BA{w, -x, -y, -z};
  const Vector3 p = rotate(R_BA, X_AB.position);
  return {{-p[0], -p[1], -p[2]}, R_BA};
}

Quaternion axisAngle(const Vector3& axis, double angle) {
  const double norm = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  const double scale = std::sin(angle / 2) / norm;
  return {std::cos(angle / 2), axis[0] * scale, axis[1] * scale, axis[2] * scale};
}

}  // namespace taxelsim
