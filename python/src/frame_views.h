// The arrays of a frame in Python.
#pragma once

#include <nanobind/ndarray.h>

#include <vector>

#include "bind.h"
#include "taxelsim/sensor.h"
#include "taxelsim/simulator.h"

namespace taxelsim::python {

// The device of DLPack that has the memory of arrays.
struct ArrayDevice {
  int type = nb::device::cpu::value;
  int number = 0;
};

// Owner and device of the arrays of a view.
struct ArrayOwner {
  nb::handle object;  // which each array keeps alive
  ArrayDevice device = {};
};

// Read-only arrays over the memory of `frame`, by name, with the batch as first axis. Nested views are dicts. Outputs that were not
// requested are missing. Arrays of the host are NumPy's; others are tuples: an object with __dlpack__(), shape, name of the type.
nb::dict arraysOf(const FrameView& frame, const Sensor& sensor, int num_instances, ArrayOwner owner);

// The measured images of `frame` alone. `rows`: the shape before that of an instance's taxels.
nb::dict imagesOf(const FrameView& frame, const Sensor& sensor, std::vector<std::size_t> rows, ArrayOwner owner);

// Writable arrays over the memory of `inputs`, as arraysOf() makes those of a frame.
nb::dict arraysOf(const ExportedInputs& inputs, int num_instances, ArrayOwner owner);

}  // namespace taxelsim::python
