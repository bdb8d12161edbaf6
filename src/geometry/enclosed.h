// Components of a closed mesh that lie inside of other components, by the winding number of vertical rays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim {

// For each component (num_components): whether its extreme vertices along x, y and z, six in all, lie inside of other components. Touching
// from outside is not inside. `mesh` is closed with outward winding, component_of[t] is the component of triangle t. Rays are tested with
// the triangles in their range of x: O(n sqrt(m)) for n triangles and m components that are spread evenly over a plane.
std::vector<bool> enclosedComponents(const Mesh& mesh, std::span<const std::uint32_t> component_of, std::size_t num_components);

}  // namespace taxelsim
