// Selects which parts of StampModel the images support, and fits them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "characterize/stamp_model.h"

namespace taxelsim {

// Fits in stages: unclipped readings first, then all readings; then gains of taxels, a bent curve, gains of presses and tilt, each if it
// improves the fit significantly. `model` receives the selected parts; remarks name what was added.
StampFit selectStampModel(StampModel& model, std::vector<std::string>& remarks);

// Fitted gain of a taxel.
double gainOf(const StampModel& model, const StampFit& found, std::size_t taxel);

}  // namespace taxelsim
