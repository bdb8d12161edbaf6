// The arrays of a batch of episodes in Python.
#pragma once

#include "bind.h"
#include "taxelsim/environment.h"

namespace taxelsim::python {

// Read-only arrays over the memory of `view`, by name; "frame" is the dict of the sensors' outputs, with num_instances x num_sensors rows.
// Each array keeps `owner` alive; with an owner of None an array is valid during the call only.
nb::dict arraysOf(const EnvironmentView& view, const Sensor& sensor, int num_sensors, nb::handle owner);

// Read-only arrays over the memory of `state`, by name. Each keeps `owner` alive.
nb::dict arraysOf(const TaskState& state, nb::handle owner);

}  // namespace taxelsim::python
