// Which rows of a data set `taxelsim inspect` reads for its statistics: all of a small data set, evenly spaced shards of a large one.
#pragma once

#include <cstdint>
#include <vector>

#include "taxelsim/dataset.h"

namespace taxelsim::cli {

struct RowRange {
  std::uint64_t first = 0;
  std::uint64_t count = 0;
};

struct ShardSample {
  std::uint64_t num_shards = 0;  // that are read
  std::vector<RowRange> frames;  // their rows, in order; those of adjacent shards are one range
  std::vector<RowRange> episodes;
};

// `all`: all shards, whatever their size.
ShardSample sampleShards(const DatasetReader& reader, bool all);

}  // namespace taxelsim::cli
