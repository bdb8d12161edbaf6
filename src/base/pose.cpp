#include "taxelsim/pose.h"

#include <cmath>

#include "base/pose_inline.h"
#include "base/quaternion.h"
#include "base/vector3.h"

namespace taxelsim {

Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return inlined::normalized(product(a, b));
}

std::array<double, 9> rotationMatrix(const Quaternion& q) {
  return inlined::rotationMatrix(q);
}

Vector3 rotate(const Quaternion& R_AB, const Vector3& v_B) {
  return inlined::transform(inlined::rotationMatrix(R_AB), v_B);
}

Vector3 operator*(const Pose& X_AB, const Vector3& p_B) {
  return add(X_AB.position, rotate(X_AB.rotation, p_B));
}

Pose operator*(const Pose& X_AB, const Pose& X_BC) {
  return inlined::compose(X_AB, X_BC);
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
