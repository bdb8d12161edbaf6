// What the blocks of passes are bound to: one buffer per block, found by the type of the block.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/pass_interface.h"

namespace taxelsim::gpu {

// Buffers must outlive it.
class Bindings {
 public:
  template <typename Block>
  void bind(const Buffer& buffer) {
    bind(Block::kIndex, buffer);
  }
  void bind(std::size_t block_index, const Buffer& buffer) {
    if (buffers_.size() <= block_index) buffers_.resize(block_index + 1, nullptr);
    buffers_[block_index] = &buffer;
  }

  // `Block` gets the buffer of another block, for a pass that serves both.
  template <typename Block, typename Other>
  void redirect() {
    bind<Block>(buffer<Other>());
  }

  // Throws std::logic_error for a block without a buffer.
  template <typename Block>
  const Buffer& buffer() const {
    if (Block::kIndex >= buffers_.size() || buffers_[Block::kIndex] == nullptr) {
      throw std::logic_error(std::string("no buffer is bound to block ") + Block::kName);
    }
    return *buffers_[Block::kIndex];
  }

  // The buffers of a pass by binding. Throws std::logic_error for a block without a buffer.
  template <typename Pass>
  auto of() const {
    return select<Pass>(std::make_integer_sequence<std::uint32_t, countBuffers<Pass>()>());
  }

 private:
  template <typename Pass, std::uint32_t... kBindings>
  std::array<const Buffer*, sizeof...(kBindings)> select(std::integer_sequence<std::uint32_t, kBindings...>) const {
    return {&buffer<BlockAt<Pass, kBindings>>()...};
  }

  std::vector<const Buffer*> buffers_;  // by the index of the block
};

}  // namespace taxelsim::gpu
