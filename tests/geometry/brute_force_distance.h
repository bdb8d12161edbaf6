// Distances to surfaces the slow way, independent of the code under test: every triangle, its three sides and its face.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "support/random_scene.h"
#include "taxelsim/object.h"

namespace taxelsim {

inline Vector3 vertexOf(const Mesh& mesh, std::size_t triangle, std::size_t corner) {
  const std::array<float, 3>& v = mesh.vertices.at(mesh.triangles.at(triangle)[corner]);
  return {v[0], v[1], v[2]};
}

inline Vector3 along(const Vector3& a, const Vector3& b, double part) {
  return {a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]), a[2] + part * (b[2] - a[2])};
}

inline double distanceBetween(const Vector3& a, const Vector3& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

inline double distanceToSide(const Vector3& p, const Vector3& a, const Vector3& b) {
  double projected = 0, squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    projected += (p[axis] - a[axis]) * (b[axis] - a[axis]);
    squared += (b[axis] - a[axis]) * (b[axis] - a[axis]);
  }
  return distanceBetween(p, along(a, b, squared > 0 ? std::clamp(projected / squared, 0.0, 1.0) : 0));
}

inline double distanceToTriangle(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  const double nearest_side = std::min({distanceToSide(p, a, b), distanceToSide(p, b, c), distanceToSide(p, c, a)});
  const auto cross = [](const Vector3& u, const Vector3& v) -> Vector3 {
    return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  };
  const auto minus = [](const Vector3& u, const Vector3& v) -> Vector3 { return {u[0] - v[0], u[1] - v[1], u[2] - v[2]}; };
  const auto dot = [](const Vector3& u, const Vector3& v) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; };
  const Vector3 normal = cross(minus(b, a), minus(c, a));
  const double norm = std::sqrt(dot(normal, normal));
  const bool above = dot(cross(minus(b, a), minus(p, a)), normal) > 0 && dot(cross(minus(c, b), minus(p, b)), normal) > 0 &&
                     dot(cross(minus(a, c), minus(p, c)), normal) > 0;
  return norm > 0 && above ? std::min(nearest_side, std::abs(dot(minus(p, a), normal)) / norm) : nearest_side;
}

// m; stops looking as soon as a triangle is at most `enough` away.
inline double distanceToSurface(const Vector3& p, const Mesh& mesh, double enough = 0) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size() && nearest > enough; ++t) {
    nearest = std::min(nearest, distanceToTriangle(p, vertexOf(mesh, t, 0), vertexOf(mesh, t, 1), vertexOf(mesh, t, 2)));
  }
  return nearest;
}

// In a random triangle: uniform in it, or as often on one of its sides, where simplified surfaces are farthest off.
inline Vector3 randomPointOn(const Mesh& mesh, support::Random& random) {
  const auto t = static_cast<std::size_t>(random.integer(0, static_cast<int>(mesh.triangles.size()) - 1));
  const double across = random.chance(0.5) ? 0 : 1 - std::sqrt(random.uniform());
  const auto first = static_cast<std::size_t>(random.integer(0, 2));
  const Vector3 on_side = along(vertexOf(mesh, t, first), vertexOf(mesh, t, (first + 1) % 3), random.uniform());
  return along(on_side, vertexOf(mesh, t, (first + 2) % 3), across);
}

// The greatest distance found from random points of `from` to `to`, m; those within `enough` count as that.
inline double sampledDistance(const Mesh& from, const Mesh& to, int num_points, support::Random& random, double enough = 0) {
  double greatest = 0;
  for (int n = 0; n < num_points; ++n) greatest = std::max(greatest, distanceToSurface(randomPointOn(from, random), to, enough));
  return greatest;
}

}  // namespace taxelsim
