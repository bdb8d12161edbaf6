// BoundCheck over a whole mesh.
#pragma once

#include "geometry/surface_distance.h"

namespace taxelsim {

// Whether every point of `mesh` is proven to be at most `bound` (m) from `surface`.
inline bool isWithin(const Mesh& mesh, const Mesh& surface, double bound) {
  const TriangleTree tree(surface);
  Effort effort;
  BoundCheck check(tree, bound, effort);
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    if (check.findBeyond(cornersOf(mesh, triangle))) return false;
  }
  return true;
}

}  // namespace taxelsim
