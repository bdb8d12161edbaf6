// Stage 3 of the reference: the point spread function (paper eq. (1)), patch by patch.
#pragma once

#include <span>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// Force per taxel -> spread force per taxel, (num_taxels), N. Per source, a taxel's force is shared among its neighbours inside the patch
// in proportion to the kernel; a kernel with no weight inside the patch spreads nothing.
std::vector<double> spread(const Sensor& sensor, std::span<const double> taxel_force);

}  // namespace taxelsim::reference
