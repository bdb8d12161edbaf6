// Proves that every point of a triangle, not only a set of samples, lies within a given distance of a surface. Over all triangles of a mesh
// this bounds the one-sided Hausdorff distance; checking both directions bounds the Hausdorff distance.
//
// The distance to a convex set is a convex function. All points of a convex polygon are therefore within the bound of one triangle of the
// surface if the polygon's corners are. Otherwise the polygon is cut along the edge of the surface triangle nearest to its centroid, and
// both parts are checked again (branch and bound, as in M. Guthe, P. Borodin, R. Klein, "Fast and accurate Hausdorff distance calculation
// between meshes", J. WSCG 13, 2005):
//
//        +--------+
//       /     |    `.       left of the cut: above surface triangle A, corners within the bound of A, done
//      /      |      `.     right of it: nearest to surface triangle B, checked against B
//     +-------+--------+
//
// A polygon whose centroid is farther away than the bound is a counterexample. A polygon that is still undecided at a millionth of the
// bound in size counts as one too.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/triangle_tree.h"

namespace taxelsim {

class HausdorffBound {
 public:
  // `bound` in m. `surface` and `budget` must outlive this object.
  HausdorffBound(const TriangleTree& surface, double bound, SearchBudget& budget);

  // Returns nothing if every point of `triangle` is proven to be within the bound of the surface. Otherwise returns a point of the triangle
  // that is farther away, or not closer than a millionth below the bound, or that could not be decided before the budget was exhausted.
  std::optional<Vector3> findViolation(const TriangleCorners& triangle);

 private:
  static constexpr std::size_t kMaxCorners = 8;

  // A convex polygon, planar up to rounding.
  struct Polygon {
    std::array<Vector3, kMaxCorners> corners;
    std::size_t num_corners = 0;
    int depth = 0;  // number of cuts that produced it
  };
  // Points x with dot(normal, x - origin) > offset are outside.
  struct Plane {
    Vector3 normal;
    Vector3 origin;
    double offset;
  };

  bool isWithinBoundOf(std::uint32_t triangle, const Polygon& polygon);
  void split(const Polygon& polygon, const Vector3& centroid, double radius);
  std::optional<Plane> planeAlongNearestTriangle(const Polygon& polygon, const Vector3& centroid, double radius) const;
  static Plane bisectorPlane(const Polygon& polygon);
  static bool clip(const Plane& plane, const Polygon& polygon, Polygon& inside, Polygon& outside);

  const TriangleTree& surface_;
  double bound_;
  SearchBudget& budget_;
  std::uint32_t nearest_ = 0;  // surface triangle found by the last query; neighbouring polygons often share it
  std::vector<Polygon> stack_;
};

}  // namespace taxelsim
