// Writes a fit of StampModel into the sensor and the estimates of a Characterization.
#pragma once

#include "characterize/stamp_model.h"
#include "taxelsim/characterize.h"

namespace taxelsim {

void reportStamps(const StampModel& model, const StampFit& found, Characterization& result);

}  // namespace taxelsim
