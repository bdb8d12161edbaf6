// Meshes that are convex: a ray meets such a body between the planes of its faces, which takes no triangles.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim {

// A face's plane: the body lies where normal . p <= offset.
struct Face {
  Vector3 normal{0, 0, 0};  // unit length, outwards
  double offset = 0;        // m
};

// The faces of a closed convex mesh, triangles of one plane as one face; nothing for any other mesh, for one with more than `max_faces` of
// them, and for one whose triangles are not all wound the same way. Every vertex lies within a few roundings of a float of, or behind,
// every face.
std::optional<std::vector<Face>> convexFaces(const Mesh& mesh, std::size_t max_faces);

}  // namespace taxelsim
