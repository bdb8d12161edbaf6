// Where a straight line first meets an analytic solid, each by its own closed form, in double.
#pragma once

#include "taxelsim/object.h"

namespace taxelsim::reference {

// Smallest t for which origin + t direction (in O) lies in the closed solid: +infinity when the line misses it, -infinity when the line
// comes from within (a half-space that opens downwards). The direction need not be of unit length, and must not be zero.
double firstHit(const Sphere& sphere, const Vector3& origin, const Vector3& direction);
double firstHit(const Cylinder& cylinder, const Vector3& origin, const Vector3& direction);
double firstHit(const Capsule& capsule, const Vector3& origin, const Vector3& direction);
double firstHit(const Box& box, const Vector3& origin, const Vector3& direction);
double firstHit(const HalfSpace& half_space, const Vector3& origin, const Vector3& direction);
double firstHit(const Cone& cone, const Vector3& origin, const Vector3& direction);
double firstHit(const Torus& torus, const Vector3& origin, const Vector3& direction);

}  // namespace taxelsim::reference
