// One shard: a range of episodes in one HDF5 file. Not the directory around it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "dataset/files.h"
#include "taxelsim/dataset.h"

namespace taxelsim::dataset {

class Compressor;

// The file's content, which depends on manifest, shard and data only; it points into `data`. `compressor`: of the manifest's level, null
// where that is 0. Throws Error(kInput) when `data` does not fit the manifest, Error(kIo) when the file cannot be made.
FileContent shardImage(const Manifest& manifest, std::uint64_t shard, const ShardData& data, Compressor* compressor);

// Frames up to the end of each episode, counted from the shard's first. Throws Error(kInput), naming the file and what is wrong, unless it
// is that shard of that data set with every column in place. With `contents` all rows are read and held against their SHA-256.
std::vector<std::uint64_t> checkShard(const std::filesystem::path& file, const Manifest& manifest, std::uint64_t shard, bool contents);

// Rows [first, first + count) of a column; they must be there. Throws Error(kInput) when HDF5 cannot read them.
void readShardRows(const std::filesystem::path& file, const Column& column, std::uint64_t first, std::uint64_t count, std::byte* rows);

}  // namespace taxelsim::dataset
