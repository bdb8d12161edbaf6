/// @file
/// Contact points with forces, as a physics engine reports them: the input of a simulator that has no objects of its own.
#pragma once

#include "taxelsim/pose.h"

namespace taxelsim {

/// A point of contact with its normal force. Equation (2) of the paper assigns the force to the one taxel whose volume contains the point.
///
/// With the contact at (x, y, z) in P, taxel i takes it if
///
///     x_i - dx/2 <= x < x_i + dx/2,   y_i - dy/2 <= y < y_i + dy/2,   -thickness <= z <= contact_band,
///
/// so that the taxels of a patch partition the force. On a border between two taxels the force goes to the one of higher index. On the rim
/// of the patch it goes to the taxel inside, on either side. Where volumes of patches overlap, the first patch of the sensor takes the
/// contact.
///
/// Taxels of a list (isTaxelList()) can leave gaps between their volumes, or overlap. Let q = (x / dx)^2 + (y / dy)^2 with x and y from the
/// middle of a taxel. Among the taxels whose range of z contains the contact, the one with the smallest q takes it, the first of equals. No
/// taxel takes a contact beyond the ellipse through its corners, q = 1/2. On a flat skin, borders between neighbours are those of the
/// rectangles.
struct ContactPoint {
  Vector3 position{0, 0, 0};  ///< m, in S; each coordinate within +-kMaxContactCoordinate.
  double normal_force = 0;    ///< N, 0 to kMaxContactForce: the component along z of the patch, pressing on the skin.
};

inline constexpr double kMaxContactCoordinate = 1e6;  ///< m, largest size of a coordinate of ContactPoint::position.
inline constexpr double kMaxContactForce = 1e6;       ///< N, largest ContactPoint::normal_force.

/// m: a contact this far outside the rim of a patch still counts as on it. Covers the rounding of the rim's coordinates in an engine and in
/// float32.
inline constexpr double kRimTolerance = 1e-6;

}  // namespace taxelsim
