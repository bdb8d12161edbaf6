// How much memory this process may use.
#pragma once

#include <cstdint>
#include <filesystem>

namespace taxelsim {

// Bytes: the least of the memory of the machine, the limits of the control groups of this process (version 1 and 2) and RLIMIT_AS. What
// other processes use is not subtracted.
std::uint64_t usableMemory();

// The least limit of the control groups that `groups` lists, in the format of /proc/self/cgroup; 2^64 - 1 without a limit. `mount`: where
// control groups are mounted, usually /sys/fs/cgroup. Files that cannot be read set no limit.
std::uint64_t controlGroupMemory(const std::filesystem::path& groups, const std::filesystem::path& mount);

}  // namespace taxelsim
