// What the frames of a data set need of the loops that the device closes.
#pragma once

#include "simulation/servo_loop.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// For the columns of the scene and the judge of its task.
LoopOutputs loopOutputsOf(const Scene& scene);

}  // namespace taxelsim
