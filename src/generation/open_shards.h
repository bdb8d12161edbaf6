// Memory of the unfinished shards of a run.
#pragma once

#include "taxelsim/generate.h"

namespace taxelsim {

// Bytes that the unfinished shards of one process need at most, for its batch size. In double: the product may exceed 2^64.
double openShardBytes(const Scene& scene, const GenerateOptions& options);

}  // namespace taxelsim
