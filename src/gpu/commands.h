// A list of device commands, recorded once and submitted any number of times. The driver gets it in finish(), so that the kernels of all
// lists recorded until then are compiled in parallel.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gpu/bindings.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "gpu/pass_kernel.h"
#include "gpu/timeline.h"

namespace taxelsim::gpu {

// Kinds of access that a barrier separates.
enum class Access { kHostWrite, kKernel, kCopy, kHostRead, kIndirect };

class Commands {
 public:
  // Begins recording. `num_timestamps`: marks, each of which must be set once.
  Commands(Context& context, std::string name, std::uint32_t num_timestamps = 0);
  ~Commands();
  Commands(Commands&&) noexcept;
  Commands& operator=(Commands&&) noexcept;

  // `num_groups` workgroups, folded into two dimensions where one holds too few; kernels find their number with workgroupNumber() of
  // shaders/passes/declare.glsl.
  template <typename Pass>
  void dispatch(const PassKernel<Pass>& kernel, std::uint32_t num_groups, const Bindings& bindings) {
    dispatch(static_cast<const Kernel&>(kernel), num_groups, bindings.of<Pass>());
  }
  // As many workgroups as an earlier kernel has written to `counts`: three words from byte `offset` on, columns, rows, 1. Needs a barrier
  // to kIndirect in between.
  template <typename Pass>
  void dispatchIndirect(const PassKernel<Pass>& kernel, const Buffer& counts, std::size_t offset, const Bindings& bindings) {
    dispatchIndirect(static_cast<const Kernel&>(kernel), counts, offset, bindings.of<Pass>());
  }
  void barrier(Access before, Access after);
  // Offsets in bytes.
  void copy(const Buffer& from, const Buffer& to, std::size_t bytes, std::size_t from_offset = 0, std::size_t to_offset = 0);
  void fillZero(const Buffer& buffer);
  void timestamp(std::uint32_t mark);
  void end();

  // Waits for the kernels and gives the list to the driver; later calls do nothing. Throws Error(kDevice) when the driver refuses a kernel.
  void finish();
  // Submits the list, finished if necessary. Does not wait for the device. Must not be called again before wait().
  void submit() { submit(nullptr, {}); }
  // The same; the device begins when `timeline` has reached `after`, and sets it to `end` when it has ended.
  void submit(const Timeline* timeline, TimelinePoints points);
  // Waits for the last submit(), if any; for a GPU it polls at first. Throws Error(kDevice) when the device was lost or there was a
  // validation message.
  void wait();
  // Seconds from mark `from` to mark `to` in the last run that has ended, until the next submit(); NaN if the device has no clock.
  double seconds(std::uint32_t from, std::uint32_t to) const;

 private:
  // `buffers` by binding.
  void dispatch(const Kernel& kernel, std::uint32_t num_groups, std::span<const Buffer* const> buffers);
  void dispatchIndirect(const Kernel& kernel, const Buffer& counts, std::size_t offset, std::span<const Buffer* const> buffers);
  void bind(const Kernel& kernel, std::span<const Buffer* const> buffers);

  struct Vulkan;
  std::unique_ptr<Vulkan> vulkan_;
};

}  // namespace taxelsim::gpu
