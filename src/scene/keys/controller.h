// The keys of controllers and tasks (scene/keys/block.h).
#pragma once

#include "scene/keys/block.h"

namespace taxelsim {

const Block& servoKeys();
const Block& oneControllerKeys();  // {tactile_servo}
const Block& controllerKeys();     // of an item of `controllers`
const Block& taskKeys();

}  // namespace taxelsim
