// The arithmetic of taxelsim/pose.h for loops over many instances, where a call would cost as much as the arithmetic. Same operations in
// the same order, hence the same bits.
#pragma once

#include <cmath>

#include "base/quaternion.h"
#include "base/vector3.h"

namespace taxelsim::inlined {

inline Quaternion normalized(const Quaternion& q) {
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return {q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm};
}

inline std::array<double, 9> rotationMatrix(const Quaternion& q) {
  const auto [w, x, y, z] = q;
  return {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),  //
          2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),  //
          2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
}

inline Vector3 transform(const std::array<double, 9>& m, const Vector3& v) {
  return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2], m[6] * v[0] + m[7] * v[1] + m[8] * v[2]};
}

// X_AB X_BC.
inline Pose compose(const Pose& X_AB, const Pose& X_BC) {
  return {add(X_AB.position, transform(rotationMatrix(X_AB.rotation), X_BC.position)), normalized(product(X_AB.rotation, X_BC.rotation))};
}

// X_AB^-1 X_AC.
inline Pose relative(const Pose& X_AB, const Pose& X_AC) {
  const Quaternion R_BA = conjugate(X_AB.rotation);
  const std::array<double, 9> m = rotationMatrix(R_BA);
  const Vector3 p = transform(m, X_AB.position);
  return {add({-p[0], -p[1], -p[2]}, transform(m, X_AC.position)), normalized(product(R_BA, X_AC.rotation))};
}

}  // namespace taxelsim::inlined
