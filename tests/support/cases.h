// How many cases the tests over random scenes and over ranges of settings run. TAXELSIM_CASES=all runs all of them (scripts/campaign
// scenes), TAXELSIM_CASES=N at most N random scenes of each kind. By default tests run the few that cover each branch.
#pragma once

#include "support/test.h"

namespace taxelsim::support {

inline std::string wantedCases() {
  const char* value = std::getenv("TAXELSIM_CASES");
  return value == nullptr ? "" : value;
}

inline bool runsAllCases() {
  return wantedCases() == "all";
}

// Number of cases out of `all`; `few` by default.
inline int numCases(int few, int all) {
  return runsAllCases() ? all : few;
}

// Seeds 0 .. n - 1 for INSTANTIATE_TEST_SUITE_P: `all`, `few` by default, or as many of these as TAXELSIM_CASES says.
inline auto seeds(int few, int all) {
  const int wanted = std::atoi(wantedCases().c_str());
  return ::testing::Range(0, wanted > 0 ? std::min(wanted, few) : numCases(few, all));
}

}  // namespace taxelsim::support
