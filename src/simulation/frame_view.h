// Spans over what a batch has read back.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "simulation/batch_buffers.h"
#include "simulation/batch_options.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// Host arrays of the features that are integers, flags or enums in a view: the device computes them as float32 numbers. Reuses its memory
// from frame to frame.
class IntegerFeatures {
 public:
  // Spans from before are invalid afterwards.
  void clear() { num_used_ = 0; }

  template <typename T>
  std::span<const T> convert(std::span<const float> values);

 private:
  std::vector<std::vector<std::byte>> arrays_;
  std::size_t num_used_ = 0;
};

// The frame in `buffers`; its spans are valid as long as the buffers and `integers` are unchanged.
FrameView viewOf(const ModelData& model, const BatchOptions& options, const BatchBuffers& buffers, IntegerFeatures& integers);

}  // namespace taxelsim
