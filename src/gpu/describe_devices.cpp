#include <algorithm>
#include <sstream>

#include "base/memory.h"
#include "gpu/vulkan.h"

namespace taxelsim::gpu {
namespace {

DeviceType typeOf(vk::PhysicalDeviceType type) {
  switch (type) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return DeviceType::kDiscrete;
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return DeviceType::kIntegrated;
    case vk::PhysicalDeviceType::eVirtualGpu:
      return DeviceType::kVirtual;
    case vk::PhysicalDeviceType::eCpu:
      return DeviceType::kCpu;
    default:
      return DeviceType::kOther;
  }
}

std::string hexadecimal(const vk::ArrayWrapper1D<std::uint8_t, VK_UUID_SIZE>& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

std::string versionText(std::uint32_t version) {
  std::ostringstream out;
  out << VK_API_VERSION_MAJOR(version) << '.' << VK_API_VERSION_MINOR(version) << '.' << VK_API_VERSION_PATCH(version);
  return out.str();
}

bool usable(const vk::raii::PhysicalDevice& device) {
  if (device.getProperties().apiVersion < VK_API_VERSION_1_2) return false;
  const std::vector<vk::QueueFamilyProperties> families = device.getQueueFamilyProperties();
  return std::any_of(families.begin(), families.end(),
                     [](const vk::QueueFamilyProperties& f) { return static_cast<bool>(f.queueFlags & vk::QueueFlagBits::eCompute); });
}

}  // namespace

std::vector<DeviceInfo> describeDevices(const vk::raii::Instance& instance, std::vector<vk::raii::PhysicalDevice>* handles) {
  struct Found {
    vk::raii::PhysicalDevice handle;
    DeviceInfo info;
  };
  std::vector<Found> found;
  for (const vk::raii::PhysicalDevice& device : instance.enumeratePhysicalDevices()) {
    if (!usable(device)) continue;
    const auto chain =
        device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceVulkan11Properties, vk::PhysicalDeviceVulkan12Properties>();
    const vk::PhysicalDeviceProperties& properties = chain.get<vk::PhysicalDeviceProperties2>().properties;
    const auto& properties11 = chain.get<vk::PhysicalDeviceVulkan11Properties>();
    const auto& properties12 = chain.get<vk::PhysicalDeviceVulkan12Properties>();
    DeviceInfo info;
    info.name = std::string(properties.deviceName.data());
    info.type = typeOf(properties.deviceType);
    info.driver = std::string(properties12.driverName.data()) + " " + std::string(properties12.driverInfo.data());
    info.api_version = versionText(properties.apiVersion);
    info.uuid = hexadecimal(properties11.deviceUUID);
    const vk::PhysicalDeviceMemoryProperties memory = device.getMemoryProperties();
    for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
      if (memory.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal)
        info.memory = std::max<std::uint64_t>(info.memory, memory.memoryHeaps[i].size);
    }
    // A software device has the memory of this process, of which its driver knows no limit.
    if (info.type == DeviceType::kCpu) info.memory = std::min(info.memory, usableMemory());
    info.max_buffer = std::min<std::uint64_t>(properties.limits.maxStorageBufferRange, properties11.maxMemoryAllocationSize);
    info.subgroup_size = properties11.subgroupSize;
    info.shared_memory = properties.limits.maxComputeSharedMemorySize;
    found.push_back({device, info});
  }
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.info.type < b.info.type; });
  std::vector<DeviceInfo> infos;
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i].info.index = static_cast<int>(i);
    infos.push_back(found[i].info);
    if (handles != nullptr) handles->push_back(found[i].handle);
  }
  return infos;
}

}  // namespace taxelsim::gpu
