// Spans over what a batch has read back.
#pragma once

#include "simulation/batch_buffers.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

FrameView viewOf(const ModelData& model, const SimulatorOptions& options, const BatchBuffers& buffers);

}  // namespace taxelsim
