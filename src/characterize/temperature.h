// Gain and trigger as functions of the temperature.
#pragma once

#include <span>

#include "taxelsim/characterize.h"

namespace taxelsim {

// Mean temperature of the force curves and stamps, if they recorded at least two that differ by kLeastSpan. Throws Error(kInput), one line
// that begins with the file, if some of them have a temperature and others do not.
std::optional<TemperatureTerm> temperatureTermOf(std::span<const Measurement> measurements);

inline constexpr double kLeastSpan = 1;  // K

struct WithHalfWidth {
  double value = 0;
  double half = 0;  // of the 95 % interval; infinite: not identifiable
};

// Adds the estimates to `result` and, if they are determined, to its temperature term. `gain` in 1/K, `trigger` in N/K.
void addTemperature(Characterization& result, const WithHalfWidth& gain, const WithHalfWidth& trigger);

}  // namespace taxelsim
