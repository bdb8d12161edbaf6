// Whether a faster driver than a device's is known.
#pragma once

#include <string>

#include "taxelsim/device.h"

namespace taxelsim::cli {

// One line of advice, or nothing: docs/drivers.md has the measurements.
std::string driverAdvice(const DeviceInfo& device);

}  // namespace taxelsim::cli
