// Embree as an independent ray caster over meshes: single rays in robust mode, in float32. Trusted to about 1e-6 of the size of the scene,
// and not on a silhouette.
#pragma once

#include "reference/depth.h"
#include "support/test.h"
#include "taxelsim/object.h"

namespace taxelsim::support {

// Height (m, in P) of the lowest mesh surface over every sample of one patch, by a ray that starts below all surfaces; +infinity without a
// surface. Every object must be a mesh.
std::vector<double> embreeHeights(const GridPatch& patch, int samples_per_taxel, std::span<const reference::PlacedObject> objects);

}  // namespace taxelsim::support
