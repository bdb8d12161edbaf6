// Line intersection with the analytic solids, in closed form: slabs for box and caps (T. L. Kay and J. T. Kajiya, SIGGRAPH 1986),
// quadratics for sphere, cylinder, capsule and cone, a quartic for the torus. Double precision.
#pragma once

#include "taxelsim/object.h"

namespace taxelsim::reference {

// Smallest t for which origin + t direction (both in O, m) lies in the closed solid. +infinity if the line misses it; -infinity if it
// comes from inside, which only a half-space allows. `direction` need not be of unit length, and must not be zero.
double firstHit(const Sphere& sphere, const Vector3& origin, const Vector3& direction);
double firstHit(const Cylinder& cylinder, const Vector3& origin, const Vector3& direction);
double firstHit(const Capsule& capsule, const Vector3& origin, const Vector3& direction);
double firstHit(const Box& box, const Vector3& origin, const Vector3& direction);
double firstHit(const HalfSpace& half_space, const Vector3& origin, const Vector3& direction);
double firstHit(const Cone& cone, const Vector3& origin, const Vector3& direction);
double firstHit(const Torus& torus, const Vector3& origin, const Vector3& direction);

// Returns firstHit() as the surface over a point of the skin, the origin. A half-space that does not look down on the point has full depth,
// -infinity, if the point lies inside it, and does not press otherwise: neither a floor behind the sensor nor a wall beside it presses.
template <typename Solid>
double surfaceOver(const Solid& solid, const Vector3& origin, const Vector3& direction) {
  return firstHit(solid, origin, direction);
}
double surfaceOver(const HalfSpace& half_space, const Vector3& origin, const Vector3& direction);

}  // namespace taxelsim::reference
