// The device memory of one batch: every array of simulation/batch_arrays.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/commands.h"
#include "simulation/batch_arrays.h"

namespace taxelsim {

// Arrays of outputs by block: as the host reads them, or as another interface has imported them.
class OutputArrays {
 public:
  void set(std::size_t block_index, std::span<const std::byte> bytes) { arrays_[block_index] = bytes; }

  // Perhaps with some elements more than the batch has.
  template <typename Block>
  std::span<const typename Block::Element> output() const {
    using Element = typename Block::Element;
    const std::span<const std::byte> bytes = arrays_[Block::kIndex];
    return {reinterpret_cast<const Element*>(bytes.data()), bytes.size() / sizeof(Element)};
  }
  // An array that another interface writes.
  template <typename Block>
  std::span<typename Block::Element> writable(std::size_t count) const {
    return {const_cast<typename Block::Element*>(output<Block>().data()), count};
  }
  // The first `count` elements; none of an array that is not there.
  template <typename Block>
  std::span<const typename Block::Element> output(std::size_t count) const {
    return output<Block>().first(arrays_[Block::kIndex].empty() ? 0 : count);
  }

 private:
  std::array<std::span<const std::byte>, block::kNumBlocks> arrays_;
};

class BatchBuffers {
 public:
  explicit BatchBuffers(const BatchShape& shape);

  // An input, for the host to write. `half`: of a frame, 0, or 1 with SimulatorOptions::export_memory.
  template <typename Block>
  std::span<typename Block::Element> input(std::size_t half = 0) const {
    return at(Block::kIndex, half).device.template mappedAs<typename Block::Element>();
  }

  // Outputs as the last frame left them, for the host.
  const OutputArrays& outputs() const { return outputs_[0]; }
  template <typename Block>
  std::span<const typename Block::Element> output(std::size_t half = 0) const {
    return outputs_[half].output<Block>();
  }

  // Exports each array of frames, or of inputs; returns what `import` returns for it.
  OutputArrays exportArrays(const BatchShape& shape, bool inputs, const ImportMemory& import) const;

  // Waits.
  template <typename Block>
  void upload(gpu::Context& context, const std::vector<typename Block::Element>& values) {
    gpu::upload(context, std::as_bytes(std::span(values)), arrays_[Block::kIndex].device);
  }

  void bindTo(gpu::Bindings& bindings, std::size_t half) const;

  // Bytes of the arrays that the host may read after such commands.
  std::uint64_t bytesRead(const BatchOptions& options, ReadAfter after) const;

  // Copies to where the host reads them, as far as the host cannot read device memory.
  void recordReadback(gpu::Commands& commands, const BatchOptions& options, ReadAfter after, std::size_t half) const;

 private:
  struct Array {
    gpu::Buffer device;
    gpu::Buffer readback;  // empty where device memory is mapped

    bool isCopied() const { return readback.size() > 0; }
  };
  Array makeArray(const BatchShape& shape, const BatchArray& array) const;
  const Array& at(std::size_t block_index, std::size_t half) const {
    const Array& second = second_[block_index];
    return half == 1 && second.device.size() > 0 ? second : arrays_[block_index];
  }

  std::array<Array, block::kNumBlocks> arrays_;  // by index of the block; those of a model are empty
  std::array<Array, block::kNumBlocks> second_;  // second halves of the arrays with is_double
  std::array<OutputArrays, 2> outputs_;          // by half
};

}  // namespace taxelsim
