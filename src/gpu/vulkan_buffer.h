// Vulkan parts of Buffer and Kernel; included by this folder's sources only.
#pragma once

#include <future>

#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "gpu/vulkan.h"

namespace taxelsim::gpu {

struct Buffer::Vulkan {
  vk::raii::DeviceMemory memory = nullptr;  // before the buffer, so that it outlives it
  vk::raii::Buffer buffer = nullptr;
};

struct Kernel::Vulkan {
  vk::raii::DescriptorSetLayout set_layout = nullptr;
  vk::raii::PipelineLayout layout = nullptr;
  std::shared_future<vk::raii::Pipeline> pipeline;  // after the layout, so that it is built before that goes
};

}  // namespace taxelsim::gpu
