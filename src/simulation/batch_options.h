// Options of a batch: those of its simulator, the closed loops that the device runs, and the threads of the host.
#pragma once

#include <optional>

#include "simulation/servo_loop.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

struct BatchOptions : SimulatorOptions {
  std::optional<ServoLoopPlan> loop = {};
  int host_threads = 0;  // that share loops over the instances; 0: hostThreads()
};

}  // namespace taxelsim
