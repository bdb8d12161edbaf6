// Components of a closed mesh that lie inside of other components, by the winding number of vertical rays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim {

inline constexpr std::uint64_t kMaxWindingTests = 1'000'000'000;  // about 10 s

// For each component (num_components): whether its extreme vertices along x, y and z, six in all, lie inside of other components. Touching
// from outside is not inside. `mesh` is closed with outward winding, component_of[t] is the component of triangle t. Tests each triangle
// with the rays that start below it and above the lowest vertex of its component: O(n log m) for n triangles and m components that are side
// by side. Throws Error(kInput) after `max_tests`, which components that contain each other can take.
std::vector<bool> enclosedComponents(const Mesh& mesh, std::span<const std::uint32_t> component_of, std::size_t num_components,
                                     std::uint64_t max_tests = kMaxWindingTests);

}  // namespace taxelsim
