// Runs the built `taxelsim` as a user does.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "support/temporary_directory.h"

namespace taxelsim::testing {

struct Outcome {
  int status = 0;  // exit status, or 128 + signal
  std::string out, err;
  double cpu_after_signal = 0;  // s of the processor, of all threads
};

struct RunOptions {
  // Signal sent after `signal_after` seconds, counted from when `signal_at` is on stderr and the program has used `signal_at_cpu` seconds
  // of the processor; 0 for none.
  int signal = 0;
  double signal_after = 0;
  std::string signal_at{};
  double signal_at_cpu = 0;
  int num_signals = 1;                     // sent one after the other, `signal_after` apart
  std::vector<std::string> environment{};  // "NAME=value", added to the test's environment
  std::map<int, std::uint64_t> limits{};   // by resource of setrlimit(), for example RLIMIT_AS
};

// Runs the program without a shell.
Outcome runTaxelsim(const std::vector<std::string>& arguments, const RunOptions& options = {});

std::string contentOf(const std::filesystem::path& file);

// Expects one line with `part` on stderr and exit status 2.
void expectRefused(const Outcome& outcome, const std::string& part);

}  // namespace taxelsim::testing
