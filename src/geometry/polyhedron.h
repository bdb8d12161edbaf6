// Half-space representation of convex meshes. A ray hits a convex polyhedron if it enters all half-spaces before it leaves any, so that no
// triangle needs to be tested:
//
//                 face 1    face 2
//                    \        /
//   ray --------------*======*-------->    entry = max of the distances to faces with normal . direction < 0
//                      \    /              exit  = min of the distances to faces with normal . direction > 0
//                       \  /               hit if entry <= exit
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim {

// The plane of a face. The polyhedron lies in the half-space normal . p <= offset.
struct Face {
  Vector3 normal{0, 0, 0};  // unit length, outward
  double offset = 0;        // m
};

// Returns the faces of a closed convex mesh; coplanar triangles form one face. Returns nothing for any other mesh, for one with more
// than `max_faces` faces, and for one with inconsistent winding. No vertex lies outside a face by more than four rounding errors of
// a float32 coordinate.
std::optional<std::vector<Face>> convexFaces(const Mesh& mesh, std::size_t max_faces);

}  // namespace taxelsim
