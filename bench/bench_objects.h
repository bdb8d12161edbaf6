// Objects and poses that the benchmarks share.
#pragma once

#include <cstdint>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim::bench {

// A closed ellipsoid with full lengths `size` (m), from an icosahedron whose triangles are split in four `levels` times: 20 x 4^levels of
// them.
Mesh ellipsoid(const Vector3& size, int levels);

// A hexagonal prism of 24 triangles, 12 mm from flat to flat, 60 mm long along x; a flat looks down. That of scenes/objects/hex_prism.obj.
Mesh hexPrism();

// The surface of Cylinder{radius, length} in `segments` flat strips.
Mesh tessellatedCylinder(double radius, double length, int segments);

// How the poses of a run are spread.
struct PoseSpread {
  Quaternion laid{1, 0, 0, 0};  // R_SO before anything random: the side that looks at the skin
  bool rolls = false;           // turned about x of S by any angle first, after `laid`
};

// `count` poses X_SO: any yaw, up to 1 degree of tilt, lowest point 0.3 to 1.5 mm deep and within +-5 mm, +-15 mm of the middle along x, y.
std::vector<Pose> randomPoses(const Object& object, const PoseSpread& spread, int count, std::uint64_t seed);

}  // namespace taxelsim::bench
