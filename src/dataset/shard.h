// Content of a shard: a contiguous range of episodes in one HDF5 file. writer.cpp and reader.cpp handle the directory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/files.h"
#include "dataset/hdf5_reading.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {

class Compressor;

// Returns the content of the file, a pure function of manifest, shard and data. It points into `data`. `compressor`: with the manifest's
// level, null if that is 0. Several threads may call it. Throws Error(kInput) if `data` does not match the manifest, Error(kIo) if HDF5
// fails.
FileContent shardImage(const Manifest& manifest, std::uint64_t shard, const ShardData& data, Compressor* compressor);

struct ShardFile {
  std::filesystem::path file;
  std::uint64_t shard = 0;  // its number
};

// Checks that each file is that shard of that data set, with all columns in their types and shapes. Verifies its checksum before HDF5 opens
// it; in format 1, which has none, the SHA-256 of all rows if `contents`. A child process reads several files. Returns for each shard the
// end of each episode in frames from the start of the shard (num_episodes). Throws Error(kInput) with the first file that has a problem,
// also where it is too small for its counts.
std::vector<std::vector<std::uint64_t>> checkShardFiles(std::span<const ShardFile> shards, const Manifest& manifest, bool contents,
                                                        Isolation isolation);

using OnShardProblem = std::function<void(const ShardFile&, const Error&)>;

// The same for shards whose checksums are verified or vouched for. With `on_problem` it does not throw an Error: it calls on_problem for
// each shard that has a problem, and checks the others.
std::vector<std::vector<std::uint64_t>> checkShardContents(std::span<const ShardFile> shards, const Manifest& manifest, bool contents,
                                                           Isolation isolation, const OnShardProblem& on_problem = {});

// Rows [first, first + count) of a column in a shard.
struct ShardRows {
  std::filesystem::path file;
  std::uint64_t first = 0, count = 0;
};

// Reads rows of several shards, one after another, to `rows`. The shards must have passed checkShardFiles(), and the rows must be in range.
// A child process reads several shards. Throws Error(kInput) if HDF5 fails.
void readShardRows(std::span<const ShardRows> parts, const Column& column, Isolation isolation, std::byte* rows);

}  // namespace taxelsim::dataset
