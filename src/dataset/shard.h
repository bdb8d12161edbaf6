// Content of a shard: a contiguous range of episodes in one HDF5 file. writer.cpp and reader.cpp handle the directory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/files.h"
#include "dataset/hdf5_reading.h"
#include "taxelsim/dataset.h"

namespace taxelsim::dataset {

class Compressor;

// Returns the content of the file, a pure function of manifest, shard and data. It points into `data`. `compressor`: with the manifest's
// level, null if that is 0. Throws Error(kInput) if `data` does not match the manifest, Error(kIo) if HDF5 fails.
FileContent shardImage(const Manifest& manifest, std::uint64_t shard, const ShardData& data, Compressor* compressor);

// Checks that the file is that shard of that data set, with all columns in their types and shapes. Verifies its checksum before HDF5 opens
// it; in format 1, which has none, the SHA-256 of all rows if `contents`. Returns the end of each episode in frames from the start of the
// shard (num_episodes). Throws Error(kInput) with the file and the problem, also where the file is too small for its counts.
std::vector<std::uint64_t> checkShard(const std::filesystem::path& file, const Manifest& manifest, std::uint64_t shard, bool contents,
                                      Isolation isolation);

// The same for a shard whose checksum is verified or vouched for.
std::vector<std::uint64_t> checkShardContent(const std::filesystem::path& file, const Manifest& manifest, std::uint64_t shard,
                                             bool contents, Isolation isolation);

// Reads rows [first, first + count) of a column, which must be in range, to `rows`. The shard must have passed checkShard(). Throws
// Error(kInput) if HDF5 fails.
void readShardRows(const std::filesystem::path& file, const Column& column, std::uint64_t first, std::uint64_t count, Isolation isolation,
                   std::byte* rows);

}  // namespace taxelsim::dataset
