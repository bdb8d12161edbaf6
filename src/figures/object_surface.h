// Triangles of the shapes of objects, for figures.
#pragma once

#include <array>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim::figures {

using Triangle3 = std::array<Vector3, 3>;  // m

struct ObjectSurface {
  std::vector<Triangle3> triangles;  // in O
  bool is_outward = false;           // closed, and counter-clockwise seen from outside: a solid, or a mesh that is closed
};

// `half_side`: m, of the square that stands for a half-space.
ObjectSurface surfaceOf(const Shape& shape, double half_side);

}  // namespace taxelsim::figures
