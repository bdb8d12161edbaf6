// Which presses of stamps stood at one place.
#pragma once

#include <cstddef>
#include <vector>

#include "taxelsim/measurement.h"

namespace taxelsim {

// Number of the place of each stamp, (stamps). Presses of one fixture share a place, and so do presses without a fixture whose fitted
// positions agree within a tenth of the pitch. The fit sees all stamps and `others`; it is left out if all stamps have a fixture. Raises
// `longest` as timedFit().
std::vector<std::size_t> placesOf(const std::vector<Measurement>& stamps, const std::vector<Measurement>& others, double& longest);

}  // namespace taxelsim
