// dataset.h5: virtual HDF5 data sets that concatenate each column over all shards. Contains no rows, except meta/episode_ends.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/files.h"
#include "dataset/hdf5_reading.h"
#include "taxelsim/dataset.h"

namespace taxelsim::dataset {

// Returns the content of the file. `shard_ends`: for each shard, the end of each episode in frames from the start of the shard. Shards are
// referenced by relative names, so that the directory can be moved. Throws Error(kIo).
FileContent viewImage(const Manifest& manifest, const std::vector<std::vector<std::uint64_t>>& shard_ends);

// Verifies the checksum of the view, opens it and compares it with the manifest. Returns the end of each episode in frames from the start
// of the data set (num_episodes). Format 2 only. Throws Error(kInput) with the file and the problem.
std::vector<std::uint64_t> viewEnds(const std::filesystem::path& file, const Manifest& manifest, Isolation isolation);

}  // namespace taxelsim::dataset
