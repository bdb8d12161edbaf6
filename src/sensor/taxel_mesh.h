// A sensor from a triangle mesh with two triangles per taxel, as the paper describes its arrays.
#pragma once

#include <vector>

#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// The taxels of a welded mesh in S, outside where its triangles run counter-clockwise. Triangles 2 k and 2 k + 1 are taxel k where every
// such two share an edge; else each taxel is two triangles that share the longest edge of both, numbered by the first of them. Two
// triangles must make a convex quadrilateral, bent by at most 20 degrees along the shared edge. The taxel lies in the mean of its corners,
// looks along the cross product of the diagonals, has the quadrilateral's area and the proportions of its mean sides, x along the first.
// Throws Error(kInput) naming the triangle (from 0).
std::vector<GridPatch> taxelsOfMesh(const Mesh& mesh);

}  // namespace taxelsim
