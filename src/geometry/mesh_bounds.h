// The box of a mesh alone, for code that has no Object around it.
#pragma once

#include "taxelsim/object.h"

namespace taxelsim {

// Of the vertices that triangles use: a stray one touches nothing.
Bounds meshBounds(const Mesh& mesh);

}  // namespace taxelsim
