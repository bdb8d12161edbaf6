// A number on the device that only grows: submissions and other interfaces of the machine wait until it has reached a value, and set it.
// Needs Context::exports().timelines.
#pragma once

#include <cstdint>
#include <memory>

#include "gpu/context.h"

namespace taxelsim::gpu {

// Values of a timeline at a submission. A wait for a value that was reached long ago costs nothing.
struct TimelinePoints {
  std::uint64_t after = 0;  // reached before the device begins
  std::uint64_t end = 0;    // set when it has ended; larger than `after`
};

class Timeline {
 public:
  // Begins at 0. Throws Error(kDevice) if the driver refuses.
  explicit Timeline(Context& context);
  ~Timeline();
  Timeline(Timeline&&) noexcept;
  Timeline& operator=(Timeline&&) noexcept;

  // A new descriptor, which the caller owns. Throws Error(kDevice) if the driver refuses.
  int exportDescriptor(Context& context) const;

  struct Vulkan;  // gpu/vulkan_timeline.h
  const Vulkan& vulkan() const { return *vulkan_; }

 private:
  std::unique_ptr<Vulkan> vulkan_;
};

}  // namespace taxelsim::gpu
