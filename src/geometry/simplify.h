// Fewer triangles for the same surface, within a bound that is proven. Not a level of detail: what cannot be proven is not done.
#pragma once

#include "taxelsim/object.h"

namespace taxelsim {

// A mesh of fewer triangles, such that no point of either surface is farther than `max_error` (m, >= 0) from the other; `mesh` itself where
// that cannot be had or saves less than a tenth, where it has few triangles, or `max_error` is 0. Its vertices are vertices of `mesh`;
// edges with one triangle stay as they are. The same on every run. `mesh` must be welded (weld.h).
Mesh simplified(const Mesh& mesh, double max_error);

}  // namespace taxelsim
