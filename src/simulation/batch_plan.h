// How much memory a batch takes, and which batches are allowed.
#pragma once

#include "simulation/batch_arrays.h"
#include "simulation/model_data.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

MemoryPlan planBatch(const ModelData& model, const BatchOptions& options);

// The arrays of a batch: with candidates where it can keep them and there is room.
BatchShape shapeOf(const ModelData& model, const BatchOptions& options);

// Throws Error(kInput) when an option is out of its range or the batch does not fit, with the size that does.
void checkBatchFits(const ModelData& model, const BatchOptions& options);

}  // namespace taxelsim
