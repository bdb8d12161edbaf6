// Access of the library to the open Vulkan device of a Device.
#pragma once

#include "taxelsim/device.h"

namespace taxelsim::gpu {

class Context;

struct DeviceAccess {
  static Context& context(const Device& device) { return *device.context_; }
};

// Valid as long as any Device that shares it.
inline Context& contextOf(const Device& device) {
  return DeviceAccess::context(device);
}

}  // namespace taxelsim::gpu
