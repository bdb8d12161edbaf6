// The device memory of one batch: every array of simulation/batch_arrays.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "gpu/buffer.h"
#include "gpu/commands.h"
#include "simulation/batch_arrays.h"

namespace taxelsim {

class BatchBuffers {
 public:
  explicit BatchBuffers(const BatchShape& shape);

  // An input, for the host to write.
  template <typename Block>
  std::span<typename Block::Element> input() const {
    return arrays_[Block::kIndex].device.template mappedAs<typename Block::Element>();
  }

  // An output as the last frame left it; perhaps with some elements more than the batch has.
  template <typename Block>
  std::span<const typename Block::Element> output() const {
    return arrays_[Block::kIndex].host().template mappedAs<typename Block::Element>();
  }

  void bindTo(gpu::Bindings& bindings) const;

  // Bytes of the arrays that the host may read after such commands.
  std::uint64_t bytesRead(const BatchOptions& options, ReadAfter after) const;

  // Copies to where the host reads them, as far as the host cannot read device memory.
  void recordReadback(gpu::Commands& commands, const BatchOptions& options, ReadAfter after) const;

 private:
  struct Array {
    gpu::Buffer device;
    gpu::Buffer readback;  // empty where device memory is mapped

    bool isCopied() const { return readback.size() > 0; }
    const gpu::Buffer& host() const { return isCopied() ? readback : device; }
  };
  std::array<Array, block::kNumBlocks> arrays_;  // by index of the block; those of a model are empty
};

}  // namespace taxelsim
