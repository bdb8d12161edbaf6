// Forces of an elastic foundation under a flat stamp with a dead weight.
#pragma once

#include <vector>

#include "characterize/stamp_model.h"

namespace taxelsim {

// Force on each taxel (num_taxels), N, before the point spread function. The stamp sinks until the forces carry its load. `own` are the
// stamp's parameters (stamp_own), `stiffness` in Pa/m^exponent. All 0 if the stamp covers no taxel.
std::vector<double> forcesUnder(const StampModel& model, const Stamp& stamp, const double* own, double stiffness);

}  // namespace taxelsim
