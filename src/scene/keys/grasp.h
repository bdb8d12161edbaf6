// The keys of grasps (scene/keys/block.h).
#pragma once

#include "scene/keys/block.h"

namespace taxelsim {

const Block& graspKeys();
const Block& fingerKeys();
const Block& graspTaskKeys();

}  // namespace taxelsim
