// Proof that a surface lies within a bound of another one, every point of it, not only some samples. One-sided; both ways give a bound of
// the Hausdorff distance.
//
// A triangle's points are all within the bound of one triangle of the other surface as soon as its corners are: distance to a convex set is
// a convex function. Else the triangle is cut along the borders of what lies above the triangle that is nearest to its middle, and the
// pieces, convex polygons, are tried again:
//
//        +--------+
//       /     |    `.       left of the cut: above triangle A, within the bound of A
//      /      |      `.     right of it: nearest to triangle B, tried with B
//     +-------+--------+
//
// A piece whose middle is farther than the bound refutes it; one that has become tiny without being decided counts as beyond.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/triangle_tree.h"

namespace taxelsim {

class BoundCheck {
 public:
  // Triangles shall lie within `bound` (m) of `surface`; that and `effort` must outlive this. Nothing more is proven once the effort is
  // exhausted.
  BoundCheck(const TriangleTree& surface, double bound, Effort& effort);

  // Nothing when every point of `triangle` is within the bound: proven. Otherwise a point of it that is beyond, or within a millionth of
  // the bound of being so, or could not be decided.
  std::optional<Vector3> findBeyond(const TriangleCorners& triangle);

 private:
  static constexpr std::size_t kMaxCorners = 8;

  // A convex polygon, in a plane but for rounding.
  struct Piece {
    std::array<Vector3, kMaxCorners> corners;
    std::size_t num_corners = 0;
    int depth = 0;  // how many cuts it comes from
  };
  // Points x with dot(normal, x - origin) > offset are outside.
  struct Cut {
    Vector3 normal;
    Vector3 origin;
    double offset;
  };

  bool isCoveredBy(std::uint32_t triangle, const Piece& piece);
  void split(const Piece& piece, const Vector3& middle, double radius);
  std::optional<Cut> cutAlongNearest(const Piece& piece, const Vector3& middle, double radius) const;
  static Cut cutInHalf(const Piece& piece);
  static bool apply(const Cut& cut, const Piece& piece, Piece& inside, Piece& outside);

  const TriangleTree& surface_;
  double bound_;
  Effort& effort_;
  std::uint32_t nearest_ = 0;  // triangle of the surface that was nearest last
  std::vector<Piece> waiting_;
};

}  // namespace taxelsim
