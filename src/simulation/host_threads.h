// How many threads share loops of the host over the instances of a batch.
#pragma once

#include "taxelsim/device.h"

namespace taxelsim {

// At least 1. A software device needs the processors itself. Other devices: half of the usable processors, at most 8, each with at least
// 512 instances.
int hostThreads(DeviceType device, int num_instances);

}  // namespace taxelsim
