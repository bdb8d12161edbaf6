// Looking at what characterize() found.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "taxelsim/characterize.h"

namespace taxelsim::support {

// The estimate of that name; nullptr where there is none.
inline const Estimate* findEstimate(const Characterization& result, const std::string& parameter) {
  const auto found = std::find_if(result.estimates.begin(), result.estimates.end(),
                                  [&](const Estimate& estimate) { return estimate.parameter == parameter; });
  return found == result.estimates.end() ? nullptr : &*found;
}

// The same where it must be there; throws where it is not.
inline const Estimate& estimateOf(const Characterization& result, const std::string& parameter) {
  const Estimate* const estimate = findEstimate(result, parameter);
  if (estimate == nullptr) throw std::runtime_error("no estimate of " + parameter);
  return *estimate;
}

// Whether it was determined and its interval holds `truth`.
inline bool holds(const Estimate& estimate, double truth) {
  return estimate.determined && estimate.low <= truth && truth <= estimate.high;
}
inline bool holds(const Characterization& result, const std::string& parameter, double truth) {
  const Estimate* const estimate = findEstimate(result, parameter);
  return estimate != nullptr && holds(*estimate, truth);
}

// Of 40 runs a 95 % interval holds the truth in at least 34 with probability .997: P(X <= 33) of a binomial (40, .95) is .0034. That it
// does so in all 40 has probability .13, so that intervals far too wide show only over many parameters.
inline constexpr int kRuns = 40;
inline constexpr int kLeastInside = 34;

}  // namespace taxelsim::support
