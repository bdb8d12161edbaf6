// Vulkan part of Timeline; included by this folder's sources only.
#pragma once

#include "gpu/timeline.h"
#include "gpu/vulkan.h"

namespace taxelsim::gpu {

struct Timeline::Vulkan {
  vk::raii::Semaphore semaphore = nullptr;
};

}  // namespace taxelsim::gpu
