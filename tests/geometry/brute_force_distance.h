// Oracle for distances to surfaces: brute force over all triangles, each by its three edges and its face. Independent of TriangleTree.
#pragma once

#include "base/vector3.h"
#include "support/random_scene.h"
#include "support/test.h"
#include "taxelsim/object.h"

namespace taxelsim {

inline Vector3 vertexOf(const Mesh& mesh, std::size_t triangle, std::size_t corner) {
  const std::array<float, 3>& v = mesh.vertices.at(mesh.triangles.at(triangle)[corner]);
  return {v[0], v[1], v[2]};
}

inline Vector3 interpolate(const Vector3& a, const Vector3& b, double fraction) {
  return add(a, scale(fraction, subtract(b, a)));
}

inline double distanceToEdge(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 edge = subtract(b, a);
  const double squared_length = dot(edge, edge);
  const double fraction = squared_length > 0 ? std::clamp(dot(subtract(p, a), edge) / squared_length, 0.0, 1.0) : 0;
  return length(subtract(p, interpolate(a, b, fraction)));
}

inline double distanceToTriangle(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  const double nearest_edge = std::min({distanceToEdge(p, a, b), distanceToEdge(p, b, c), distanceToEdge(p, c, a)});
  const Vector3 normal = cross(subtract(b, a), subtract(c, a));
  const auto isInside = [&](const Vector3& from, const Vector3& to) {
    return dot(cross(subtract(to, from), subtract(p, from)), normal) > 0;
  };
  const bool projects_inside = isInside(a, b) && isInside(b, c) && isInside(c, a);
  if (!(length(normal) > 0) || !projects_inside) return nearest_edge;
  return std::min(nearest_edge, std::abs(dot(subtract(p, a), normal)) / length(normal));
}

// m. Returns early as soon as a triangle is at most `enough` away.
inline double distanceToSurface(const Vector3& p, const Mesh& mesh, double enough = 0) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size() && nearest > enough; ++t) {
    nearest = std::min(nearest, distanceToTriangle(p, vertexOf(mesh, t, 0), vertexOf(mesh, t, 1), vertexOf(mesh, t, 2)));
  }
  return nearest;
}

// A random point of a random triangle: on one of its edges in half of the calls, since simplified surfaces deviate most there.
inline Vector3 randomPointOn(const Mesh& mesh, support::Random& random) {
  const auto t = static_cast<std::size_t>(random.integer(0, static_cast<int>(mesh.triangles.size()) - 1));
  const double toward_apex = random.chance(0.5) ? 0 : 1 - std::sqrt(random.uniform());
  const auto first = static_cast<std::size_t>(random.integer(0, 2));
  const Vector3 on_edge = interpolate(vertexOf(mesh, t, first), vertexOf(mesh, t, (first + 1) % 3), random.uniform());
  return interpolate(on_edge, vertexOf(mesh, t, (first + 2) % 3), toward_apex);
}

// The largest distance (m) from random points of `from` to `to`: a lower bound of the one-sided Hausdorff distance. Distances below
// `enough` may be overestimated, but not beyond `enough`.
inline double sampledDistance(const Mesh& from, const Mesh& to, int num_points, support::Random& random, double enough = 0) {
  double largest = 0;
  for (int n = 0; n < num_points; ++n) largest = std::max(largest, distanceToSurface(randomPointOn(from, random), to, enough));
  return largest;
}

}  // namespace taxelsim
