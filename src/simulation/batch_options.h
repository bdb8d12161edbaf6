// Options of a batch: those of its simulator, and the closed loops that the device runs.
#pragma once

#include <optional>

#include "simulation/servo_loop.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

struct BatchOptions : SimulatorOptions {
  std::optional<ServoLoopPlan> loop = {};
};

}  // namespace taxelsim
