#include "control/twist.h"

#include "base/vector3.h"

namespace taxelsim {

Twist changeFrame(const Pose& X_AB, const Twist& twist_B) {
  const Vector3 w_A = rotate(X_AB.rotation, twist_B.w);
  const Vector3 v_B_A = rotate(X_AB.rotation, twist_B.v);
  return {add(v_B_A, cross(X_AB.position, w_A)), w_A};  // v_A = v_B + w x (A's origin - B's origin)
}

}  // namespace taxelsim
