#include "dataset/serial_reading.h"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>

#include "dataset/child_reading.h"
#include "dataset/hdf5.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {
namespace {

constexpr std::size_t kFilesPerChild = 500;  // HDF5 keeps memory of files that it refuses
constexpr unsigned kMaxWait = 300;           // s, of a file

// The start of the memory of the parent and its children; the outcomes follow.
struct Progress {
  std::atomic<std::size_t> at;

  Outcome* outcomes() { return reinterpret_cast<Outcome*>(this + 1); }
};

void limitChild() {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t bytes = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + dataset::ChildLimits().bytes;
  const rlimit memory{bytes, bytes}, core{0, 0};
  ::setrlimit(RLIMIT_AS, &memory);
  ::setrlimit(RLIMIT_CORE, &core);
}

// SIGPROF and SIGALRM end a process.
void startClocks() {
  const itimerval processor{{}, {static_cast<time_t>(dataset::ChildLimits().seconds), 0}};
  ::setitimer(ITIMER_PROF, &processor, nullptr);
  ::alarm(kMaxWait);
}

[[noreturn]] void runChild(Progress& progress, std::size_t end, const std::function<void(std::size_t)>& read) {
  limitChild();
  for (; progress.at < end; ++progress.at) {
    startClocks();
    Outcome outcome = Outcome::kRead;
    try {
      read(progress.at);
    } catch (const std::exception&) {  // bad_alloc, too
      outcome = Outcome::kRefused;
    }
    progress.outcomes()[progress.at] = outcome;
  }
  ::_exit(0);
}

}  // namespace

std::vector<Outcome> readSerially(std::size_t count, const std::function<void(std::size_t)>& read) {
  const std::size_t num_bytes = sizeof(Progress) + count;
  void* const memory = ::mmap(nullptr, num_bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  Progress& progress = *static_cast<Progress*>(memory);  // zeros
  while (progress.at < count) {
    const pid_t child = dataset::forkWithHdf5();
    if (child == 0) runChild(progress, std::min(count, progress.at + kFilesPerChild), read);
    int status = 0;
    if (child < 0 || ::waitpid(child, &status, 0) != child) throw std::runtime_error("no child process");
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
      throw std::runtime_error("a child waits at file " + std::to_string(progress.at));
    if (status != 0) ++progress.at;  // which stays kEnded
  }
  const std::vector<Outcome> outcomes(progress.outcomes(), progress.outcomes() + count);
  ::munmap(memory, num_bytes);
  return outcomes;
}

}  // namespace taxelsim::testing
