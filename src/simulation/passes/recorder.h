// Records dispatches of passes for one batch: the commands, and what every block is bound to.
#pragma once

#include <cstddef>
#include <cstdint>

#include "gpu/commands.h"
#include "simulation/passes/blocks.h"

namespace taxelsim {

// Workgroups for `items` of which each workgroup does `per_workgroup`.
inline std::uint32_t numWorkgroups(std::uint64_t items, std::uint32_t per_workgroup) {
  return static_cast<std::uint32_t>((items + per_workgroup - 1) / per_workgroup);
}

struct Recorder {
  gpu::Commands& commands;
  gpu::Bindings bindings;
  std::uint64_t num_instances;

  // A dispatch, and a barrier after which later passes see what it wrote.
  template <typename Interface>
  void dispatch(const gpu::PassKernel<Interface>& kernel, std::uint32_t num_workgroups) {
    commands.dispatch(kernel, num_workgroups, bindings);
    commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
  }

  // The same over the instances of a list of block Work.
  template <typename Interface>
  void dispatchOverList(const gpu::PassKernel<Interface>& kernel, std::uint32_t list) {
    commands.dispatchIndirect(kernel, bindings.buffer<block::Work>(), list * sizeof(block::Work::Element), bindings);
    commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
  }

  // Copies `count` rows of block EmptyWork, from row `from` on, to rows `to` and following of Work, between dispatches.
  void copyWorkRows(std::uint32_t from, std::uint32_t to, std::uint32_t count) {
    constexpr std::size_t kRow = sizeof(block::Work::Element);
    commands.barrier(gpu::Access::kKernel, gpu::Access::kCopy);
    commands.copy(bindings.buffer<block::EmptyWork>(), bindings.buffer<block::Work>(), count * kRow, from * kRow, to * kRow);
    commands.barrier(gpu::Access::kCopy, gpu::Access::kKernel);
  }
};

}  // namespace taxelsim
