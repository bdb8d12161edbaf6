// Bounding volume hierarchy over the triangles of a mesh, for nearest-triangle queries in double precision on the host. The device culls
// with clusters (clusters.h) instead.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim {

using TriangleCorners = std::array<Vector3, 3>;  // m

TriangleCorners cornersOf(const Mesh& mesh, std::uint32_t triangle);

// Squared distance (m^2) from `point` to the triangle. For a needle-shaped triangle the result may be too large, since it then refers to
// another point of the triangle than the nearest. It is never too small, except for rounding.
double squaredDistance(const Vector3& point, const TriangleCorners& triangle);

// Limit on the number of boxes and triangles visited. Bounds the running time for malicious meshes independently of the machine.
struct SearchBudget {
  std::uint64_t max = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t spent = 0;
  const std::atomic<bool>* stop = nullptr;  // exhausts it when *stop becomes true

  bool isExhausted() const { return spent > max || isStopped(); }
  bool isStopped() const { return stop != nullptr && *stop; }
};

// That of the SimplificationStop of this thread, else null.
const std::atomic<bool>* stopOfThisThread();

class TriangleTree {
 public:
  struct Nearest {
    std::uint32_t triangle = 0;  // index in the mesh
    double distance = 0;         // m
  };

  // Copies the triangles. Indices must be in range and coordinates finite. Triangles may overlap and may be degenerate.
  explicit TriangleTree(const Mesh& mesh);

  // The nearest triangle at most `limit` (m) away, if any. Adds its cost to `budget`, but does not stop when that is exhausted.
  std::optional<Nearest> nearest(const Vector3& point, double limit, SearchBudget& budget) const;

  const TriangleCorners& corners(std::uint32_t triangle) const { return corners_[triangle]; }
  std::size_t numTriangles() const { return corners_.size(); }
  double largestCoordinate() const;  // m, largest absolute value of any coordinate

 private:
  struct Node {
    std::array<float, 3> low;
    std::array<float, 3> high;
    std::uint32_t first;  // leaf: first entry in order_; inner node: its second child (the first child follows the node)
    std::uint32_t count;  // leaf: number of triangles; inner node: 0
  };

  void build(const Mesh& mesh, std::uint32_t first, std::uint32_t end);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;  // triangles, grouped by leaf
  std::vector<TriangleCorners> corners_;
};

}  // namespace taxelsim
