// Advice on faster drivers.
#pragma once

#include <string>

#include "taxelsim/device.h"

namespace taxelsim::cli {

// One line of advice, or empty. Measurements: docs/how_to/drivers.md.
std::string driverAdvice(const DeviceInfo& device);

}  // namespace taxelsim::cli
