// The keys of sensor files (scene/keys/block.h).
#pragma once

#include "scene/keys/block.h"

namespace taxelsim {

// Tolerance of the length of a quaternion; four decimal digits suffice.
inline constexpr double kUnitTolerance = 1e-3;

// A sensor in place has the same keys but format_version.
const Block& sensorKeys();

const Block& poseKeys();      // {position, rotation | rpy}
const Block& rotationKeys();  // {rotation | rpy}
const Block& patchKeys();
const Block& taxelKeys();
const Block& taxelMeshKeys();
const Block& taxelUrdfKeys();
const Block& skinKeys();
const Block& psfKeys();
const Block& skinGaussianKeys();
const Block& gaussianKeys();
const Block& readoutKeys();
const Block& curveKeys();
const Block& threeAxisKeys();

// Keys that every file has: format_version, with that default, and name.
KeyTable fileKeys(std::string format_version);
// Default of format_version in a block that may be in place in another file.
inline constexpr const char* kNeededInFile = "required in a file of its own";
// The key `sha256` of a file that another key names.
Key sha256Key();
// The key `up_axis` of a mesh file.
Key upAxisKey();

}  // namespace taxelsim
