// Folders of the Linux control groups that limit a process.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace taxelsim {

// Folders that may hold files of limits: of the groups of a process and of all groups around them.
struct ControlGroups {
  std::vector<std::filesystem::path> version_2, version_1;
};

// The groups that the file `groups` lists, in the format of /proc/self/cgroup. `mount`: where control groups are mounted, usually
// /sys/fs/cgroup. `controller`: the one whose groups of version 1 are wanted, "memory" or "cpu".
ControlGroups controlGroups(const std::filesystem::path& groups, const std::filesystem::path& mount, const std::string& controller);

}  // namespace taxelsim
