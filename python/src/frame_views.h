// The arrays of a frame in Python.
#pragma once

#include "bind.h"
#include "taxelsim/sensor.h"
#include "taxelsim/simulator.h"

namespace taxelsim::python {

// Read-only arrays over the memory of `frame`, by name, with the batch as first axis. Each array keeps `owner` alive. Nested views are
// dicts. Outputs that were not requested are missing.
nb::dict arraysOf(const FrameView& frame, const Sensor& sensor, int num_instances, nb::handle owner);

}  // namespace taxelsim::python
