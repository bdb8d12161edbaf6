#include "reference/solid_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "base/vector3.h"

namespace taxelsim::reference {
namespace {

// h(n) in O.
struct Support {
  Vector3 n;

  double across() const { return std::hypot(n[0], n[1]); }
  double operator()(const Mesh&) const { return kInfinity; }
  double operator()(const HalfSpace&) const { return kInfinity; }
  double operator()(const Sphere& s) const { return s.radius * length(n); }
  double operator()(const Cylinder& c) const { return c.radius * across() + c.length / 2 * std::abs(n[2]); }
  double operator()(const Capsule& c) const { return c.radius * length(n) + c.length / 2 * std::abs(n[2]); }
  double operator()(const Box& b) const {
    return (b.size[0] * std::abs(n[0]) + b.size[1] * std::abs(n[1]) + b.size[2] * std::abs(n[2])) / 2;
  }
  double operator()(const Cone& c) const { return std::max(0.0, c.radius * across() + c.height * n[2]); }
  double operator()(const Torus& t) const { return t.major_radius * across() + t.minor_radius * length(n); }
};

double support(const Shape& shape, const Pose& X_PO, const Vector3& n_P) {
  return dot(n_P, X_PO.position) + std::visit(Support{rotate(inverse(X_PO).rotation, n_P)}, shape);
}

// Of the upper bounds boundAlong(n), n = -x, x, -y, y of P.
template <typename BoundAlong>
Rectangle rectangleOf(BoundAlong boundAlong) {
  return {{-boundAlong({-1, 0, 0}), -boundAlong({0, -1, 0})}, {boundAlong({1, 0, 0}), boundAlong({0, 1, 0})}};
}

}  // namespace

Rectangle projectedBounds(const Shape& shape, const Pose& X_PO, const Vector3& direction_P) {
  return rectangleOf([&](const Vector3& n) { return support(shape, X_PO, {n[0], n[1], -dot(n, direction_P) / direction_P[2]}); });
}

// Where z <= 0, n . p <= n . p - a z for every a >= 0, which is at most h(n - a e_z). The smallest of these bounds is exact for convex
// shapes.
Rectangle pressedBounds(const Shape& shape, const Pose& X_PO) {
  if (support(shape, X_PO, {0, 0, -1}) <= 0) return {};
  return rectangleOf([&](const Vector3& n) {
    constexpr double kFirst = 1.0 / 64, kLast = 1024, kFactor = 1.25;
    double least = support(shape, X_PO, n);
    for (double a = kFirst; a < kLast; a *= kFactor) least = std::min(least, support(shape, X_PO, {n[0], n[1], -a}));
    return least;
  });
}

}  // namespace taxelsim::reference
