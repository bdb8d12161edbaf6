// The arrays of a batch of episodes in Python.
#pragma once

#include "bind.h"
#include "taxelsim/environment.h"
#include "taxelsim/grasp_environment.h"

namespace taxelsim::python {

// Read-only arrays over the memory of `view`, by name; "frame" is the dict of the sensors' outputs, with num_instances x num_sensors rows.
// Each array keeps `owner` alive; with an owner of None an array is valid during the call only.
nb::dict arraysOf(const EnvironmentView& view, const Sensor& sensor, int num_sensors, nb::handle owner);

// The same of a scene of kind grasp. "sensors" has of each sensor by its name "frame", the dict of the outputs of the sensors that share
// its settings, with all rows of its frame, and "first_row", the row of instance 0.
nb::dict arraysOf(const GraspView& view, nb::handle owner);

// Read-only arrays over the memory of `state`, by name. Each keeps `owner` alive.
nb::dict arraysOf(const TaskState& state, nb::handle owner);
nb::dict arraysOf(const GraspState& state, int num_instances, nb::handle owner);

}  // namespace taxelsim::python
