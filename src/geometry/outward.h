// Orientation of closed meshes: which side of a triangle is outside. Mesh files may wind their triangles either way.
#pragma once

#include <optional>

#include "taxelsim/object.h"

namespace taxelsim {

// The welded mesh (weld.h) with counter-clockwise winding seen from outside, so that (b - a) x (c - a) points out of the body. Returns
// nothing unless the mesh is closed and orientable: every edge belongs to exactly two triangles, and no component is a Klein bottle.
//
// Triangles keep their order. Each component (triangles connected by edges) is oriented by its signed volume. A component inside of
// another one, such as the wall of a cavity, is removed: seen from outside it is behind the enclosing component. Coordinates must be
// finite and indices in range. O(n log n) for n triangles of one component; for several, see enclosedComponents().
std::optional<Mesh> outwardMesh(const Mesh& mesh);

}  // namespace taxelsim
