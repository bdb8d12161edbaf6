// Points of contact with their forces, as another engine reports them: the input of a simulator that has no objects of its own.
#pragma once

#include "taxelsim/pose.h"

namespace taxelsim {

// Paper eq. (2) gives the force of a contact to the one taxel whose volume it lies in. With the contact at (x, y, z) in P, taxel i takes
//   x_i - dx/2 <= x < x_i + dx/2,   y alike,   -thickness <= z <= contact_band,
// so that the taxels of a patch partition the force: on a border between two taxels it goes to the one of higher index. On the rim of the
// patch it goes to the taxel inside, on either side. Where volumes of patches overlap, the first patch of the sensor takes the contact.
//
// Taxels with places of their own (isTaxelList()) leave wedges between their volumes, or share them. Of those with z in the same range the
// one takes the contact in whose rectangle it lies nearest the middle, by q = (x / dx)^2 + (y / dy)^2 with x and y from there, the first of
// equals; none beyond the ellipse through the corners, q = 1/2. On a flat skin borders between neighbours are those of the rectangles.
struct ContactPoint {
  Vector3 position{0, 0, 0};  // m, in S, each coordinate within kMaxContactCoordinate
  double normal_force = 0;    // N, 0 to kMaxContactForce: the part of the force along z of the patch, pressing on the skin
};

inline constexpr double kMaxContactCoordinate = 1e6;  // m
inline constexpr double kMaxContactForce = 1e6;       // N

// How far outside the rim of a patch a contact still counts as on it, m: what an engine and float32 make of the rim's coordinates.
inline constexpr double kRimTolerance = 1e-6;

}  // namespace taxelsim
