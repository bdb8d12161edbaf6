// dataset.h5: every column of every shard as one, by HDF5 virtual data sets. Holds no frames itself.
#pragma once

#include <cstdint>
#include <vector>

#include "dataset/files.h"
#include "taxelsim/dataset.h"

namespace taxelsim::dataset {

// The file's content. `shard_ends` are the ends of episodes in each shard, counted from the shard's first frame. Shards are named relative
// to the view, so that the directory can be moved.
FileContent viewImage(const Manifest& manifest, const std::vector<std::vector<std::uint64_t>>& shard_ends);

}  // namespace taxelsim::dataset
