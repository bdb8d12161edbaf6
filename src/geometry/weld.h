// Makes an indexed mesh from loose triangles: one vertex per position, no triangle without area.
#pragma once

#include "taxelsim/object.h"

namespace taxelsim {

// Joins vertices whose coordinates are equal (0 and -0 are), drops triangles that use a vertex twice or whose area is exactly zero, then
// vertices that no triangle uses. Order of triangles and of first use is kept. All coordinates must be finite, all indices in range.
Mesh weld(const Mesh& mesh);

// Whether a triangle with these corners is more than a point or a line.
bool hasArea(const std::array<float, 3>& a, const std::array<float, 3>& b, const std::array<float, 3>& c);

}  // namespace taxelsim
