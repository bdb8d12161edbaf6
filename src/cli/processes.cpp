#include "cli/processes.h"

#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <thread>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/run_display.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {
namespace {

constexpr int kMaxProcesses = 1024;
constexpr auto kWatchPeriod = std::chrono::milliseconds(50);

// A process, and a file in memory with its Progress and then what it returned, or why it failed.
struct Child {
  pid_t process = 0;  // 0 once it has ended
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file{::fdopen(::memfd_create("result", MFD_CLOEXEC), "w+"), &std::fclose};

  void writeProgress(const Progress& progress) const {
    [[maybe_unused]] auto n = ::pwrite(fileno(file.get()), &progress, sizeof progress, 0);
  }

  Progress readProgress() const {
    Progress progress;
    return ::pread(fileno(file.get()), &progress, sizeof progress, 0) == sizeof progress ? progress : Progress{};
  }

  bool writeResult(const std::string& result) const {
    std::fseek(file.get(), sizeof(Progress), SEEK_SET);
    return std::fwrite(result.data(), 1, result.size(), file.get()) == result.size() && std::fflush(file.get()) == 0;
  }

  std::string readResult() const {
    std::fseek(file.get(), 0, SEEK_END);
    std::string result(static_cast<std::size_t>(std::max(std::ftell(file.get()) - static_cast<long>(sizeof(Progress)), 0L)), '\0');
    std::fseek(file.get(), sizeof(Progress), SEEK_SET);
    result.resize(std::fread(result.data(), 1, result.size(), file.get()));
    return result;
  }
};

// A flag that this process and its forks share.
using SharedFlag = std::unique_ptr<std::atomic<bool>, void (*)(std::atomic<bool>*)>;

SharedFlag makeSharedFlag() {
  using Flag = std::atomic<bool>;
  void* const memory = ::mmap(nullptr, sizeof(Flag), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  return {new (memory) Flag(false), [](Flag* flag) { ::munmap(flag, sizeof *flag); }};
}

[[noreturn]] void doWork(const Child& child, int number, pid_t parent, const std::atomic<bool>& stop, const Work& work) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) std::_Exit(kExitDevice);  // it ended before that call
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
  if (number > 0) spdlog::set_level(spdlog::level::err);  // the others would repeat what the first one says
  Failure end{.status = kExitOk, .message = {}};
  try {
    end.message = work({.number = number, .stop = stop, .report = [&](const Progress& own) { child.writeProgress(own); }});
  } catch (const std::exception&) {
    end = currentFailure();
  }
  const bool is_written = child.writeResult(end.message);
  std::_Exit(is_written ? end.status : kExitDevice);
}

// Sum over the processes. Without episodes until each has reported some.
Progress progressOf(const std::vector<Child>& children) {
  Progress sum;
  for (const Child& child : children) {
    const Progress own = child.readProgress();
    if (own.num_episodes == 0) return {};
    add(sum, own);
  }
  return sum;
}

// The failure of a process, from its status by waitpid().
Failure failureOf(const Child& child, const std::string& name, int status) {
  if (WIFSIGNALED(status))
    return {kExitDevice, fmt::format("{}: killed by signal {} ({})", name, WTERMSIG(status), ::strsignal(WTERMSIG(status)))};
  const std::string reason = child.readResult();
  if (reason.empty()) return {kExitDevice, fmt::format("{}: ended with status {}", name, WEXITSTATUS(status))};
  return {WEXITSTATUS(status), WEXITSTATUS(status) == kExitInput ? reason : name + ": " + reason};
}

}  // namespace

void addProcessesOption(CLI::App& command, int& num_processes) {
  command.add_option("--processes", num_processes, "Processes of this machine that share the work")
      ->check(silent(CLI::Range(1, kMaxProcesses)))
      ->capture_default_str()
      ->type_name("N");
  const auto refuse = [](const std::string&) { throw CLI::ValidationError("--workers", "is --processes now"); };
  command.add_option_function<std::string>("--workers", refuse)->group("");
}

int usableProcesses(int num_requested, std::uint64_t num_parts) {
  return static_cast<int>(std::clamp<std::uint64_t>(num_parts, 1, static_cast<std::uint64_t>(num_requested)));
}

void add(Progress& sum, const Progress& more) {
  sum.episodes_done += more.episodes_done;
  sum.num_episodes += more.num_episodes;
  sum.frames_done += more.frames_done;
  sum.num_frames += more.num_frames;
  sum.episodes_resumed += more.episodes_resumed;
  sum.seconds = std::max(sum.seconds, more.seconds);
}

int batchShare(int batch_size, int num_processes) {
  return std::max(1, batch_size / num_processes);
}

std::vector<std::string> forkProcesses(int num_processes, const Work& work) {
  const std::atomic<bool>& stop = stopOnSignals();
  const SharedFlag shared_stop = makeSharedFlag();
  std::fflush(nullptr);  // the processes would write it again
  std::vector<Child> children(static_cast<std::size_t>(num_processes));
  const pid_t parent = ::getpid();
  for (int number = 0; number < num_processes; ++number) {
    Child& child = children[static_cast<std::size_t>(number)];
    child.process = child.file ? ::fork() : -1;
    if (child.process == 0) doWork(child, number, parent, *shared_stop, work);
    if (child.process < 0)
      throw Error(ErrorKind::kDevice, fmt::format("cannot start process {} of {}: {}", number + 1, num_processes, std::strerror(errno)));
  }
  RunDisplay display;
  std::optional<Failure> failure;
  while (std::ranges::any_of(children, [](const Child& child) { return child.process != 0; })) {
    std::this_thread::sleep_for(kWatchPeriod);
    if (stop || failure) *shared_stop = true;
    for (std::size_t number = 0; number < children.size(); ++number) {
      Child& child = children[number];
      int status = 0;
      if (child.process == 0 || ::waitpid(child.process, &status, WNOHANG) != child.process) continue;
      child.process = 0;
      if (status != 0 && !failure) failure = failureOf(child, fmt::format("process {} of {}", number + 1, num_processes), status);
    }
    if (const Progress progress = progressOf(children); progress.num_episodes > 0) display.show(progress);
  }
  if (failure) throw Error(failure->status == kExitInput ? ErrorKind::kInput : ErrorKind::kDevice, failure->message);
  std::vector<std::string> results;
  for (const Child& child : children) results.push_back(child.readResult());
  return results;
}

std::vector<std::string> runProcesses(int num_processes, const Work& work) {
  if (num_processes > 1) return forkProcesses(num_processes, work);
  RunDisplay display;
  return {work({.number = 0, .stop = stopOnSignals(), .report = [&](const Progress& progress) { display.show(progress); }})};
}

}  // namespace taxelsim::cli
