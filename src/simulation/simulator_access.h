// Access of the library to the implementation of a Simulator, and simulators with options that the public header does not show.
#pragma once

#include "base/thread_team.h"
#include "simulation/batch_options.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

struct SimulatorAccess {
  static Simulator::Impl& impl(Simulator& simulator) { return *simulator.impl_; }

  // Throws as the constructor of Simulator, and std::system_error if a thread cannot be created.
  static Simulator make(const Model& model, const BatchOptions& options);
  // The threads that share its loops over instances. The simulator uses them during its calls only.
  static ThreadTeam& team(Simulator& simulator);
};

}  // namespace taxelsim
