#include "base/processors.h"

#include <sched.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <thread>

#include "base/control_groups.h"

namespace taxelsim {
namespace {

constexpr int kNoQuota = std::numeric_limits<int>::max();

// A quota of 1.5 processors counts as 1.
int processorsOf(std::int64_t quota, std::int64_t period) {
  if (quota <= 0 || period <= 0) return kNoQuota;  // version 1 writes -1 for no quota
  return static_cast<int>(std::clamp<std::int64_t>(quota / period, 1, kNoQuota));
}

std::int64_t numberIn(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::int64_t number = 0;
  stream >> number;
  return number;
}

}  // namespace

int controlGroupProcessors(const std::filesystem::path& groups, const std::filesystem::path& mount) {
  const ControlGroups folders = controlGroups(groups, mount, "cpu");
  int least = kNoQuota;
  for (const std::filesystem::path& group : folders.version_2) {
    std::ifstream stream(group / "cpu.max");  // "150000 100000", or "max 100000" for no quota
    std::int64_t quota = 0, period = 0;
    if (stream >> quota >> period) least = std::min(least, processorsOf(quota, period));
  }
  for (const std::filesystem::path& group : folders.version_1)
    least = std::min(least, processorsOf(numberIn(group / "cpu.cfs_quota_us"), numberIn(group / "cpu.cfs_period_us")));
  return least;
}

int usableProcessors() {
  cpu_set_t allowed;
  // Fails on machines of more than CPU_SETSIZE (1,024) processors.
  const int num_allowed =
      ::sched_getaffinity(0, sizeof(allowed), &allowed) == 0 ? CPU_COUNT(&allowed) : static_cast<int>(std::thread::hardware_concurrency());
  return std::max(1, std::min(num_allowed, controlGroupProcessors("/proc/self/cgroup", "/sys/fs/cgroup")));
}

}  // namespace taxelsim
