// Scores of predicted counts.
#pragma once

#include <span>

#include "taxelsim/cross_validate.h"

namespace taxelsim {

// All metrics but the centre, which is NaN. `full_scale` in counts.
PredictionScore scoreOf(std::span<const double> predicted, std::span<const double> real, double full_scale);

// The same for an image, with its centre.
PredictionScore scoreOfImage(const Sensor& sensor, std::span<const double> predicted, std::span<const double> real);

}  // namespace taxelsim
