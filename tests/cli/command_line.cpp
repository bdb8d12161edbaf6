#include "cli/command_line.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "support/test.h"

namespace taxelsim::testing {

namespace {

double secondsOf(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

double cpuSeconds(pid_t process) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

RunningTaxelsim::RunningTaxelsim(const std::vector<std::string>& arguments, const RunOptions& options) {
  const std::string out = directory_ / "out", err = directory_ / "err";
  process_ = fork();
  if (process_ == 0) {
    setpgid(0, 0);
    dup2(open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
    dup2(open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    std::vector<char*> argv{const_cast<char*>("taxelsim")};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    for (const std::string& variable : options.environment) putenv(const_cast<char*>(variable.c_str()));
    for (const auto& [resource, limit] : options.limits) {
      const rlimit both{limit, limit};
      setrlimit(static_cast<__rlimit_resource>(resource), &both);
    }
    execv(TAXELSIM_EXECUTABLE, argv.data());
    _exit(127);
  }
  setpgid(process_, process_);  // in both, so that neither is too late
}

void RunningTaxelsim::waitForStderr(const std::string& text, double cpu_seconds) const {
  siginfo_t ended{};
  while (contentOf(directory_ / "err").find(text) == std::string::npos || cpuSeconds(process_) < cpu_seconds) {
    if (waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 || ended.si_pid != 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void RunningTaxelsim::send(int signal) {
  cpu_at_signal_ = cpuSeconds(process_);
  kill(process_, signal);
}

Outcome RunningTaxelsim::wait() {
  if (!is_waited_for_) wait4(process_, &status_, 0, &used_);
  is_waited_for_ = true;
  return {.status = WIFSIGNALED(status_) ? 128 + WTERMSIG(status_) : WEXITSTATUS(status_),
          .out = contentOf(directory_ / "out"),
          .err = contentOf(directory_ / "err"),
          .cpu_after_signal = secondsOf(used_.ru_utime) + secondsOf(used_.ru_stime) - cpu_at_signal_};
}

Outcome runTaxelsim(const std::vector<std::string>& arguments, const RunOptions& options) {
  RunningTaxelsim program(arguments, options);
  if (options.signal != 0) program.waitForStderr(options.signal_at, options.signal_at_cpu);
  for (int n = 0; options.signal != 0 && n < options.num_signals; ++n) {
    std::this_thread::sleep_for(std::chrono::duration<double>(options.signal_after));
    program.send(options.signal);
  }
  return program.wait();
}

Outcome succeed(const std::vector<std::string>& arguments, const RunOptions& options) {
  const Outcome outcome = runTaxelsim(arguments, options);
  if (outcome.status == 0) return outcome;
  std::string words;
  for (const std::string& word : arguments) words += " " + word;
  throw std::runtime_error("taxelsim" + words + " ends with status " + std::to_string(outcome.status) + ":\n" + outcome.err);
}

nlohmann::json jsonOf(const std::vector<std::string>& arguments) {
  return nlohmann::json::parse(succeed(arguments).out);
}

void expectRefused(const Outcome& outcome, const std::string& part) {
  EXPECT_EQ(outcome.status, 2) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_TRUE(outcome.err.ends_with("\n")) << outcome.err;
  EXPECT_TRUE(outcome.err.starts_with("taxelsim: ")) << outcome.err;
  EXPECT_THAT(outcome.err, ::testing::HasSubstr(part));
}

}  // namespace taxelsim::testing
