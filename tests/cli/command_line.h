// Runs the built `taxelsim` as a user does.
#pragma once

#include <sys/resource.h>
#include <sys/types.h>

#include <nlohmann/json_fwd.hpp>

#include "support/temporary_directory.h"
#include "support/test.h"

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

// The program while it runs, without a shell, as the leader of a process group. Waits for it at the end.
class RunningTaxelsim {
 public:
  explicit RunningTaxelsim(const std::vector<std::string>& arguments, const RunOptions& options = {});
  ~RunningTaxelsim() { wait(); }
  RunningTaxelsim(const RunningTaxelsim&) = delete;
  RunningTaxelsim& operator=(const RunningTaxelsim&) = delete;

  pid_t process() const { return process_; }
  // Waits until the text is on stderr and the program has used the seconds of the processor, or it has ended.
  void waitForStderr(const std::string& text, double cpu_seconds = 0) const;
  void send(int signal);
  Outcome wait();

 private:
  TemporaryDirectory directory_;
  pid_t process_ = 0;
  bool is_waited_for_ = false;
  int status_ = 0;
  double cpu_at_signal_ = 0;
  rusage used_{};
};

// Runs the program to its end.
Outcome runTaxelsim(const std::vector<std::string>& arguments, const RunOptions& options = {});

// Runs the program to its end. Throws unless its exit status is 0.
Outcome succeed(const std::vector<std::string>& arguments, const RunOptions& options = {});

// What a run that succeeds prints, parsed.
nlohmann::json jsonOf(const std::vector<std::string>& arguments);

// Expects one line with `part` on stderr and exit status 2.
void expectRefused(const Outcome& outcome, const std::string& part);

}  // namespace taxelsim::testing
