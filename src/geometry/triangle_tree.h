// Which triangle of a mesh is nearest to a point: a binary tree of boxes. For checks at load, in double precision; the device has its own
// structure (clusters.h).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim {

using TriangleCorners = std::array<Vector3, 3>;  // m

// Corners of triangle number `triangle` of the mesh.
TriangleCorners cornersOf(const Mesh& mesh, std::uint32_t triangle);

// The square of the distance from `point` to the triangle. For a sliver it may be that to another point of it than the nearest, but never
// to a point outside: it errs to the large side only, but for rounding.
double squaredDistance(const Vector3& point, const TriangleCorners& triangle);

// Boxes and triangles that were looked at. An end to it bounds the time that a mesh can take which is made to take long, and the same on
// every machine.
struct Effort {
  std::uint64_t max = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t spent = 0;

  bool isExhausted() const { return spent > max; }
};

class TriangleTree {
 public:
  struct Nearest {
    std::uint32_t triangle = 0;  // of the mesh
    double distance = 0;         // m
  };

  // Copies what it needs. Indices must be in range and coordinates finite; triangles may have any shape, overlap or have no area.
  explicit TriangleTree(const Mesh& mesh);

  // The nearest triangle, if there is one at most `limit` (m) away. Finds it also when the effort is exhausted.
  std::optional<Nearest> nearest(const Vector3& point, double limit, Effort& effort) const;

  const TriangleCorners& corners(std::uint32_t triangle) const { return corners_[triangle]; }
  std::size_t numTriangles() const { return corners_.size(); }
  double largestCoordinate() const;  // m, of any vertex along any axis, without its sign

 private:
  struct Node {
    std::array<float, 3> low;
    std::array<float, 3> high;
    std::uint32_t first;  // of a leaf: place in order_; of others: their second child, the first one comes right behind them
    std::uint32_t count;  // of a leaf: triangles; of others: 0
  };

  void build(const Mesh& mesh, std::uint32_t first, std::uint32_t end);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;  // triangles, those of a leaf one after another
  std::vector<TriangleCorners> corners_;
};

}  // namespace taxelsim
