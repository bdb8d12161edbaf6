// Objects that samples at points may miss.
#pragma once

#include <span>

#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// Logs a warning for each object that is narrower than two samples of a sensor with DepthSampling::kPoint, or than one if it is longer than
// the array: the force of such an object depends on where it lies between the samples. The warning says what would see it.
void warnOfSmallObjects(const Sensor& sensor, std::span<const Object> objects);

}  // namespace taxelsim
