// The library's own way from a public Device to the open Vulkan device behind it.
#pragma once

#include "taxelsim/device.h"

namespace taxelsim::gpu {

class Context;

struct DeviceAccess {
  static Context& context(const Device& device) { return *device.context_; }
};

// The context of an open device; lives as long as any Device that shares it.
inline Context& contextOf(const Device& device) {
  return DeviceAccess::context(device);
}

}  // namespace taxelsim::gpu
