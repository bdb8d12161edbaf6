// Runs the program on a driver that fails (failing_driver.cpp).
#pragma once

#include "cli/command_line.h"
#include "support/test.h"

namespace taxelsim::testing {

inline constexpr int kManyFaults = 10'000;  // a bound for loops that end earlier

// `variable`: of the layer, with the number of the call that fails.
inline RunOptions failing(const std::string& variable, int number) {
  return {.environment = {"VK_LAYER_PATH=" TAXELSIM_LAYERS, "VK_INSTANCE_LAYERS=VK_LAYER_TAXELSIM_failing_driver",
                          variable + "=" + std::to_string(number)}};
}

// Expects exit status 1 and one line with `part`.
inline void expectDeviceError(const Outcome& outcome, const std::string& part) {
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
}

}  // namespace taxelsim::testing
