// Mesh simplification with a proven error bound.
//
//   for target error = 1.2, 0.84, 0.59, ... x max_error, at most 8 times:
//     collapse edges by quadric error metrics until the target error is reached (meshopt_simplify; M. Garland, P. S. Heckbert, "Surface
//       simplification using quadric error metrics", SIGGRAPH 1997). The metric measures a mean error, which bounds nothing.
//     at most 20 times (SimplificationRepair):
//       find the triangles of both surfaces with a point farther than max_error from the other surface (HausdorffBound)
//       if there are none: done, the bound is proven
//       at each of them, insert a vertex of the original or flip an edge
//
// The result is deterministic: one thread, ties broken by index, and a limit on the number of operations rather than on time.
#pragma once

#include <cstdint>

#include "taxelsim/object.h"

namespace taxelsim {

// Changes whenever simplifyMesh() returns other meshes than before: stored results of older versions are not used then.
inline constexpr std::uint32_t kSimplificationVersion = 1;

// Returns a mesh with fewer triangles whose two-sided Hausdorff distance to `mesh` is at most `max_error` (m, >= 0). Vertices are a subset
// of those of `mesh`. Edges with a single triangle (boundaries) are kept.
// Returns `mesh` itself where max_error is 0, where it has fewer than 64 triangles, and where fewer than 10 % of the triangles can be
// removed within the bound. `mesh` must be welded (weld.h).
Mesh simplifyMesh(const Mesh& mesh, double max_error);

}  // namespace taxelsim
