// Vulkan parts of Buffer and Kernel; included by this folder's sources only.
#pragma once

#include <future>
#include <mutex>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "gpu/vulkan.h"

namespace taxelsim::gpu {

struct Buffer::Vulkan {
  vk::raii::DeviceMemory memory = nullptr;  // before the buffer, so that it outlives it
  std::uint64_t memory_bytes = 0;
  vk::raii::Buffer buffer = nullptr;
  std::once_flag viewed;
  vk::raii::BufferView texels = nullptr;  // once viewAsTexels() has been called
};

struct Kernel::Vulkan {
  std::vector<vk::DescriptorType> types;  // of its buffers
  vk::raii::DescriptorSetLayout set_layout = nullptr;
  vk::raii::PipelineLayout layout = nullptr;
  std::shared_future<vk::raii::Pipeline> pipeline;  // declared after the layout, so that it is complete before the layout is destroyed
};

}  // namespace taxelsim::gpu
