// The keys of objects (scene/keys/block.h).
#pragma once

#include "scene/keys/block.h"

namespace taxelsim {

const Block& objectKeys();        // of an object that is drawn
const Block& placedObjectKeys();  // of an object of a grasp

}  // namespace taxelsim
