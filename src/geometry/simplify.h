// Mesh simplification with a proven error bound.
//
//     +--> meshopt_simplify: quadric edge collapse to a target error (M. Garland, P. S. Heckbert, "Surface simplification using
//     |      |                 quadric error metrics", SIGGRAPH 1997); its error is a mean, so it bounds nothing
//     |      v
//     |    HausdorffBound: is every point of either surface within max_error of the other one?  --- yes --> done
//     |      | no: the triangles where it fails                                       ^
//     |      v                                                                        |
//     |    SimplificationRepair: insert a vertex of the original or flip an edge -----+
//     |      |
//     |      v  too many triangles or rounds
//     +--- target error x 0.7
//
// The result is deterministic: one thread, ties broken by index, and a limit on the number of operations rather than on time.
#pragma once

#include "taxelsim/object.h"

namespace taxelsim {

// Returns a mesh with fewer triangles whose two-sided Hausdorff distance to `mesh` is at most `max_error` (m, >= 0). Vertices are a subset
// of those of `mesh`. Edges with a single triangle (boundaries) are kept.
// Returns `mesh` itself where max_error is 0, where it has fewer than 64 triangles, and where fewer than 10 % of the triangles can be
// removed within the bound. `mesh` must be welded (weld.h).
Mesh simplifyMesh(const Mesh& mesh, double max_error);

}  // namespace taxelsim
