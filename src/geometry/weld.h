// Vertex welding: makes an indexed mesh with one vertex per position and no degenerate triangle.
#pragma once

#include "taxelsim/object.h"

namespace taxelsim {

// Merges vertices with equal coordinates (0 and -0 are equal), then removes triangles whose area is exactly zero and vertices that no
// triangle uses. Keeps the order of the triangles; vertices are in the order of first use. Coordinates must be finite and indices in range.
Mesh weld(const Mesh& mesh);

// False for degenerate triangles: those with an area of exactly zero.
bool hasArea(const std::array<float, 3>& a, const std::array<float, 3>& b, const std::array<float, 3>& c);

}  // namespace taxelsim
