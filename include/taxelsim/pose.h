/// @file
/// Rigid transforms and twists at the interface. `X_AB` takes coordinates in B to coordinates in A (monogram notation).
#pragma once

#include <array>

namespace taxelsim {

using Vector3 = std::array<double, 3>;     ///< (x, y, z).
using Quaternion = std::array<double, 4>;  ///< (w, x, y, z), of unit length.

/// X_AB: the pose of frame B in frame A. The default is the identity.
struct Pose {
  Vector3 position{0, 0, 0};        ///< m, position of B's origin in A.
  Quaternion rotation{1, 0, 0, 0};  ///< Rotation R_AB of B in A.

  bool operator==(const Pose&) const = default;  ///< Exact comparison of all components.
};

/// Velocity of a frame relative to the world, in the frame's own axes.
struct Twist {
  Vector3 v{0, 0, 0};  ///< m/s, linear velocity of the frame's origin.
  Vector3 w{0, 0, 0};  ///< rad/s, angular velocity.

  bool operator==(const Twist&) const = default;  ///< Exact comparison of all components.
};

/// Composition X_AC = X_AB * X_BC. The rotation is normalised again, so that long chains do not drift.
Pose operator*(const Pose& X_AB, const Pose& X_BC);

/// X_BA from X_AB.
Pose inverse(const Pose& X_AB);

/// Coordinates in A of the point with coordinates p_B in B.
Vector3 operator*(const Pose& X_AB, const Vector3& p_B);

/// v_A from v_B: rotation alone, for directions.
Vector3 rotate(const Quaternion& R_AB, const Vector3& v_B);

/// Rotation by `angle` (rad) about `axis`, of any length but 0.
Quaternion axisAngle(const Vector3& axis, double angle);

/// Composition R_AC = R_AB * R_BC, normalised.
Quaternion operator*(const Quaternion& R_AB, const Quaternion& R_BC);

/// Rotation matrix (3 x 3), row-major.
std::array<double, 9> rotationMatrix(const Quaternion& R_AB);

}  // namespace taxelsim
