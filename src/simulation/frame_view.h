// Spans over what a batch has read back.
#pragma once

#include "simulation/batch_buffers.h"
#include "simulation/batch_options.h"
#include "simulation/integer_features.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// The frame in `arrays`; its spans are valid as long as these and `integers` are unchanged. Arrays that are not there give empty spans.
FrameView viewOf(const ModelData& model, const BatchOptions& options, const OutputArrays& arrays, IntegerFeatures& integers);

}  // namespace taxelsim
