// Embree as an independent ray caster over meshes: single rays in robust mode, in float32. An oracle for depth, trusted to about 1e-6 of
// the size of the scene and not at all on a silhouette.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "reference/depth.h"
#include "taxelsim/object.h"

namespace taxelsim::support {

// Height over every sample of one patch of the lowest mesh surface, m in P, found by a ray that starts below all of them; +infinity where
// there is none. Every object must be a mesh.
std::vector<double> embreeHeights(const GridPatch& patch, int samples_per_taxel, std::span<const reference::PlacedObject> objects);

}  // namespace taxelsim::support
