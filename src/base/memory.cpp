#include "base/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace taxelsim {
namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

// The number in a file; none in "max", the text for no limit.
std::uint64_t limitIn(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::uint64_t limit = 0;
  return stream >> limit ? limit : kNoLimit;
}

// Of a group and all groups around it.
std::uint64_t leastLimit(std::filesystem::path group, const std::filesystem::path& mount, const char* name) {
  std::uint64_t least = limitIn(mount / name);  // inside a container the mount is its own group
  for (; group.has_relative_path(); group = group.parent_path()) least = std::min(least, limitIn(mount / group.relative_path() / name));
  return least;
}

}  // namespace

std::uint64_t controlGroupMemory(const std::filesystem::path& groups, const std::filesystem::path& mount) {
  std::ifstream stream(groups);
  std::uint64_t least = kNoLimit;
  for (std::string line; std::getline(stream, line);) {  // "0::/user.slice", "4:memory:/jobs/7"
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const std::filesystem::path group = line.substr(second + 1);
    if (controllers == ",,") least = std::min(least, leastLimit(group, mount, "memory.max"));
    if (controllers.find(",memory,") != std::string::npos)
      least = std::min(least, leastLimit(group, mount / "memory", "memory.limit_in_bytes"));
  }
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
