#include "base/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "base/control_groups.h"

namespace taxelsim {
namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

// The number in a file; none in "max", the text for no limit.
std::uint64_t limitIn(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::uint64_t limit = 0;
  return stream >> limit ? limit : kNoLimit;
}

}  // namespace

std::uint64_t controlGroupMemory(const std::filesystem::path& groups, const std::filesystem::path& mount) {
  const ControlGroups folders = controlGroups(groups, mount, "memory");
  std::uint64_t least = kNoLimit;
  for (const std::filesystem::path& group : folders.version_2) least = std::min(least, limitIn(group / "memory.max"));
  for (const std::filesystem::path& group : folders.version_1) least = std::min(least, limitIn(group / "memory.limit_in_bytes"));
  return least;
}

std::uint64_t usableMemory() {
  const auto pages = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES));
  const std::uint64_t machine = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  rlimit address_space{};
  const bool is_limited = ::getrlimit(RLIMIT_AS, &address_space) == 0 && address_space.rlim_cur != RLIM_INFINITY;
  const std::uint64_t process = is_limited ? address_space.rlim_cur : kNoLimit;
  return std::min({machine, process, controlGroupMemory("/proc/self/cgroup", "/sys/fs/cgroup")});
}

}  // namespace taxelsim
