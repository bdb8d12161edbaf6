// A list of device commands, recorded once and submitted as often as wanted. It is handed to the driver when all is recorded, so that the
// kernels of a list, and of all lists recorded before one is finished, are compiled at once.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "gpu/pass.h"

namespace taxelsim::gpu {

// What was done before a barrier must be visible to what is done after it.
enum class Access { kHostWrite, kKernel, kCopy, kHostRead, kIndirect };

class Commands {
 public:
  // Begins recording. `num_timestamps` marks are to be set, each once.
  Commands(Context& context, std::string name, std::uint32_t num_timestamps = 0);
  ~Commands();
  Commands(Commands&&) noexcept;
  Commands& operator=(Commands&&) noexcept;

  // `num_groups` workgroups, folded into two dimensions where one holds too few; kernels find their number with workgroupNumber() of
  // shaders/common/workgroup.glsl.
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
  void copy(const Buffer& from, const Buffer& to, std::size_t bytes);
  void fillZero(const Buffer& buffer);
  void timestamp(std::uint32_t mark);
  void end();

  // Waits for the kernels and hands the list to the driver, once. Throws Error(kDevice) when the driver refuses a kernel.
  void finish();
  // Starts them on the device, finished first; does not wait for the device. The same list must not be submitted again before wait().
  void submit();
  // Waits for the last submit(), if any. Throws Error(kDevice) when the device was lost or validation complained.
  void wait();
  // Seconds from mark `from` to mark `to` of the last run waited for, until it is submitted again; NaN where the device has no clock.
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
