// HausdorffBound for all triangles of a mesh.
#pragma once

#include "geometry/hausdorff_bound.h"

namespace taxelsim {

// True if every point of `mesh` is proven to be at most `bound` (m) from `surface`.
inline bool isWithin(const Mesh& mesh, const Mesh& surface, double bound) {
  const TriangleTree tree(surface);
  SearchBudget budget;
  HausdorffBound check(tree, bound, budget);
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    if (check.findViolation(cornersOf(mesh, triangle))) return false;
  }
  return true;
}

}  // namespace taxelsim
