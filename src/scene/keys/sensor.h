// The keys of sensor files (scene/keys/block.h).
#pragma once

#include "scene/keys/block.h"

namespace taxelsim {

// Also of a sensor in place, but for format_version.
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
// Of blocks that are also in place in another file.
inline constexpr const char* kNeededInFile = "required in a file of its own";
// The key `sha256` of a file that another key names.
Key sha256Key();
// The key `up_axis` of a mesh file.
Key upAxisKey();

}  // namespace taxelsim
