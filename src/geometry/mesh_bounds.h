// Bounding box of a mesh.
#pragma once

#include "taxelsim/object.h"

namespace taxelsim {

// Axis-aligned box in O, m, of the vertices that triangles use. Unused vertices are ignored.
Bounds meshBounds(const Mesh& mesh);

}  // namespace taxelsim
