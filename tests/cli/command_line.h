// Runs the built `taxelsim` as a user does.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace taxelsim::testing {

struct Outcome {
  int status = 0;  // exit status, or 128 + signal
  std::string out, err;
};

// The program sees its arguments as given, without a shell.
Outcome runTaxelsim(const std::vector<std::string>& arguments);

// One complete line on stderr, and exit status 2.
void expectRefused(const Outcome& outcome, const std::string& part);

}  // namespace taxelsim::testing
