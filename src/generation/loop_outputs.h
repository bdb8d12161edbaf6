// What the frames of a data set need of the loops that the device closes.
#pragma once

#include "generation/columns.h"
#include "simulation/servo_loop.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// For the columns and the judge of the scene's task.
LoopOutputs loopOutputsOf(const Scene& scene, const ColumnPlan& columns);

}  // namespace taxelsim
