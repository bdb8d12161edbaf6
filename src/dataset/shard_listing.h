// Which shards of a data set are on disk.
#pragma once

#include <filesystem>
#include <vector>

#include "taxelsim/dataset.h"

namespace taxelsim::dataset {

// (num_shards), whether the directory has a file of that name, of whatever kind. Lists the directory once: a query per shard takes minutes
// on a network file system. Throws Error(kIo) if the directory cannot be listed.
std::vector<bool> shardsOnDisk(const std::filesystem::path& directory, const Manifest& manifest);

}  // namespace taxelsim::dataset
