// Objects and poses that the benchmarks share.
#pragma once

#include <cstdint>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim::bench {

// A closed ellipsoid with full lengths `size` (m): an icosahedron, subdivided `levels` times into 20 x 4^levels triangles.
Mesh ellipsoid(const Vector3& size, int levels);

// A hexagonal prism of 24 triangles, 12 mm from flat to flat, 60 mm long along x; a flat faces down. The same as
// scenes/objects/hex_prism.obj.
Mesh hexPrism();

// Cylinder{radius, length} as a mesh of `segments` flat strips.
Mesh tessellatedCylinder(double radius, double length, int segments);

// Distribution of the poses of a run.
struct PoseSpread {
  Quaternion laid{1, 0, 0, 0};  // R_SO before any random rotation: selects the side that faces the skin
  bool rolls = false;           // whether to rotate about x of S by a random angle, after `laid`
};

// `count` poses X_SO: any yaw, up to 1 degree of tilt, lowest point 0.3 to 1.5 mm deep and within +-5 mm, +-15 mm of the middle along x, y.
std::vector<Pose> randomPoses(const Object& object, const PoseSpread& spread, int count, std::uint64_t seed);

}  // namespace taxelsim::bench
