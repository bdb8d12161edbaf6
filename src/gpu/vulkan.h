// Vulkan objects behind the types of this folder; included by its sources only.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <utility>
#include <vulkan/vulkan_raii.hpp>

#include "gpu/context.h"

namespace taxelsim::gpu {

// Every buffer can be bound in every way that a pass reads or writes.
inline constexpr vk::BufferUsageFlags kBufferUsage =
    vk::BufferUsageFlagBits::eStorageBuffer | vk::BufferUsageFlagBits::eUniformBuffer | vk::BufferUsageFlagBits::eUniformTexelBuffer |
    vk::BufferUsageFlagBits::eStorageTexelBuffer | vk::BufferUsageFlagBits::eIndirectBuffer | vk::BufferUsageFlagBits::eTransferSrc |
    vk::BufferUsageFlagBits::eTransferDst;

struct Context::Vulkan {
  explicit Vulkan(vk::raii::Context&& opened) : loader(std::move(opened)) {}

  vk::raii::Context loader;
  vk::raii::Instance instance = nullptr;
  vk::raii::DebugUtilsMessengerEXT messenger = nullptr;
  vk::raii::PhysicalDevice physical = nullptr;
  vk::raii::Device device = nullptr;
  vk::raii::Queue queue = nullptr;
  vk::raii::PipelineCache pipeline_cache = nullptr;
  std::uint32_t queue_family = 0;
  std::uint32_t timestamp_bits = 0;
  double timestamp_period = 0;  // s
  bool debug_names = false;
  std::mutex queue_mutex;
  std::atomic<bool> pipelines_changed = false;
  std::mutex message_mutex;
  std::string first_message;

  template <typename Handle>
  void name(const Handle& handle, const std::string& text) {
    if (!debug_names) return;
    using CType = typename Handle::CType;
    const auto raw = reinterpret_cast<std::uint64_t>(static_cast<CType>(*handle));
    device.setDebugUtilsObjectNameEXT({Handle::objectType, raw, text.c_str()});
  }
};

// Runs `call` and converts exceptions of Vulkan to Error(kDevice). `what`: the object or action, with its size, for the message; `advice`:
// what to do when memory runs out.
[[noreturn]] void throwDeviceError(const vk::SystemError& error, const std::string& what, const std::string& advice);

template <typename Call>
auto checked(const std::string& what, const std::string& advice, Call&& call) {
  try {
    return call();
  } catch (const vk::SystemError& error) {
    throwDeviceError(error, what, advice);
  }
}

std::vector<DeviceInfo> describeDevices(const vk::raii::Instance& instance, std::vector<vk::raii::PhysicalDevice>* handles);

}  // namespace taxelsim::gpu
