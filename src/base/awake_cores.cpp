#include "base/awake_cores.h"

#include <pthread.h>
#include <sched.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

namespace taxelsim {
namespace {

// Of a larger machine, small batches do not reach all cores.
constexpr std::size_t kMostThreads = 16;

// Linux moves a thread that waits for its core only to one that has nothing to do, not even work of this policy. So a core that nobody else
// wanted for this long, which is longer than the gap between two kernels of a step, is left alone until the next call.
constexpr std::chrono::microseconds kAlone(500);
// A turn of the loop that took longer had somebody else run.
constexpr std::chrono::microseconds kTurn(20);

// Whether a control group of this process, or one above it, has a quota of processor time.
bool hasQuota() {
  std::ifstream groups("/proc/self/cgroup");
  const auto limits = [](const std::filesystem::path& file, const std::string& none) {
    std::ifstream in(file);
    std::string quota;
    return static_cast<bool>(in >> quota) && quota != none;
  };
  const std::filesystem::path root = "/sys/fs/cgroup";
  // In a container, its own group is the root.
  if (limits(root / "cpu.max", "max") || limits(root / "cpu/cpu.cfs_quota_us", "-1")) return true;
  for (std::string line; std::getline(groups, line);) {  // hierarchy:controllers:/path
    const std::size_t at = line.find(":/");
    if (at == std::string::npos) continue;
    for (std::filesystem::path path = line.substr(at + 2); !path.empty(); path = path.parent_path()) {
      if (limits(root / path / "cpu.max", "max") || limits(root / "cpu" / path / "cpu.cfs_quota_us", "-1")) return true;
    }
  }
  return false;
}

// The cores that the calling thread may use, at most kMostThreads.
std::vector<int> ownCores() {
  std::vector<int> cores;
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof(set), &set) != 0) return cores;
  for (int core = 0; core < CPU_SETSIZE && cores.size() < kMostThreads; ++core)
    if (CPU_ISSET(core, &set)) cores.push_back(core);
  return cores;
}

// Left alone, two of the threads come to be on one core while another halts. False where the thread may not be there any more.
bool stayOn(int core) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(core, &set);
  return sched_setaffinity(0, sizeof(set), &set) == 0;
}

}  // namespace

void AwakeCores::start() {
  std::call_once(started_, [this] {
    if (hasQuota()) return;
    try {
      for (const int core : ownCores()) {
        threads_.emplace_back([this, core] { keepAwake(core); });
        ++num_threads_;
      }
    } catch (const std::system_error&) {  // NOLINT(bugprone-empty-catch): no more threads may be started; fewer do
    }
  });
}

AwakeCores::~AwakeCores() {
  calls_ = kEnd;
  calls_.notify_all();
  for (std::thread& thread : threads_) {
    // On a busy machine it would hardly come to see that.
    const sched_param parameters{};
    pthread_setschedparam(thread.native_handle(), SCHED_OTHER, &parameters);
    thread.join();
  }
}

void AwakeCores::stayAwake() {
  // Never kEnd. Of calls at the same time one may be lost, and another counts.
  calls_ = (calls_ + 1) & std::numeric_limits<int>::max();
  if (num_awake_ < num_threads_) calls_.notify_all();
}

void AwakeCores::keepAwake(int core) {
  const sched_param parameters{};
  if (!stayOn(core) || pthread_setschedparam(pthread_self(), SCHED_IDLE, &parameters) != 0) {
    --num_threads_;
    return;
  }
  using Clock = std::chrono::steady_clock;
  for (int seen = 0; seen != kEnd;) {
    calls_.wait(seen);
    ++num_awake_;
    Clock::time_point now = Clock::now(), last_call = now, alone_since = now;
    while (seen != kEnd && now - last_call < kAwake && now - alone_since < kAlone) {
      sched_yield();  // or it would give way only at the scheduler's next tick, up to 4 ms later
      const Clock::time_point before = std::exchange(now, Clock::now());
      if (const int calls = std::exchange(seen, calls_); calls != seen) last_call = alone_since = now;
      if (now - before > kTurn) alone_since = now;
    }
    --num_awake_;
  }
}

}  // namespace taxelsim
