// Access to the estimates of characterize().
#pragma once

#include "support/test.h"
#include "taxelsim/characterize.h"

namespace taxelsim::support {

// The estimate of this name; nullptr if there is none.
inline const Estimate* findEstimate(const Characterization& result, const std::string& parameter) {
  const auto found = std::find_if(result.estimates.begin(), result.estimates.end(),
                                  [&](const Estimate& estimate) { return estimate.parameter == parameter; });
  return found == result.estimates.end() ? nullptr : &*found;
}

// The same; throws if there is none.
inline const Estimate& estimateOf(const Characterization& result, const std::string& parameter) {
  const Estimate* const estimate = findEstimate(result, parameter);
  if (estimate == nullptr) throw std::runtime_error("no estimate of " + parameter);
  return *estimate;
}

// True if the estimate is determined and its interval contains `truth`.
inline bool holds(const Estimate& estimate, double truth) {
  return estimate.determined && estimate.low <= truth && truth <= estimate.high;
}
inline bool holds(const Characterization& result, const std::string& parameter, double truth) {
  const Estimate* const estimate = findEstimate(result, parameter);
  return estimate != nullptr && holds(*estimate, truth);
}

// A 95 % interval contains the truth in at least 34 of 40 runs with probability .997: P(X <= 33) of a binomial (40, .95) is .0034. All 40
// have probability .13, so that too wide intervals are detected over many parameters only.
inline constexpr int kRuns = 40;
inline constexpr int kLeastInside = 34;

}  // namespace taxelsim::support
