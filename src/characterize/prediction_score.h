// Scores of predicted counts.
#pragma once

#include <span>
#include <vector>

#include "taxelsim/cross_validate.h"

namespace taxelsim {

// All metrics but the centre, which is NaN. `full_scale` in counts.
PredictionScore scoreOf(std::span<const double> predicted, std::span<const double> real, double full_scale);

// The same for an image, with its centre.
PredictionScore scoreOfImage(const Sensor& sensor, std::span<const double> predicted, std::span<const double> real);

// What a prediction that is exactly the mean of all presses of a load would score on one of them, `real`, from `others`, the remaining
// recorded presses of this load. Their mean differs from `real` by the scatter of both: with n others sqrt(1 + 1/n) times the standard
// deviation of one press, which is divided out. NaN without others, and for active taxels, to which this does not apply.
PredictionScore scoreOfMeanPress(const Sensor& sensor, std::span<const std::vector<double>> others, std::span<const double> real);

}  // namespace taxelsim
