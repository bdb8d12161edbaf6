// Access of the library to the implementation of a Simulator, and simulators whose device runs closed loops.
#pragma once

#include "simulation/batch_options.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

struct SimulatorAccess {
  static Simulator::Impl& impl(Simulator& simulator) { return *simulator.impl_; }

  // Throws as the constructor of Simulator.
  static Simulator make(const Model& model, const BatchOptions& options);
};

}  // namespace taxelsim
