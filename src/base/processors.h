// How many processors this process may use.
#pragma once

#include <filesystem>

namespace taxelsim {

// At least 1: the least of the processors in the affinity mask of the calling thread and the quotas of the control groups of this process
// (version 1 and 2). What other processes use is not subtracted.
int usableProcessors();

// The least quota of the control groups that `groups` lists, in whole processors, at least 1; INT_MAX without a quota. `groups` and
// `mount`: as of controlGroups(). Files that cannot be read set no quota.
int controlGroupProcessors(const std::filesystem::path& groups, const std::filesystem::path& mount);

}  // namespace taxelsim
