// A Vulkan device, opened for compute. Not a wrapper for Vulkan: no Vulkan type shows here.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace taxelsim {

namespace gpu {
class Context;
struct DeviceAccess;
}  // namespace gpu

enum class DeviceType { kDiscrete, kIntegrated, kVirtual, kCpu, kOther };

struct DeviceInfo {
  int index = 0;  // place in listDevices()
  std::string name;
  DeviceType type = DeviceType::kOther;
  std::string driver;            // name and version, as the driver gives them
  std::string api_version;       // "1.3.230"
  std::string uuid;              // of the device, hexadecimal
  std::uint64_t memory = 0;      // bytes of the largest device-local heap
  std::uint64_t max_buffer = 0;  // bytes that one storage buffer can hold
  std::uint32_t subgroup_size = 0;
  std::uint32_t shared_memory = 0;  // bytes per workgroup
};

struct DeviceOptions {
  // "discrete", "integrated", "cpu", an index into listDevices(), or part of a device's name. Empty: TAXELSIM_DEVICE if set, else the
  // best there is (discrete before integrated before virtual before CPU).
  std::string device{};
  // Core and synchronisation validation; also switched on by TAXELSIM_VALIDATION=1. Any message makes the next wait throw. Throws when
  // the layers are not installed.
  bool validation = false;
  // Compiled kernels are kept for the next process, in a file of the user's cache folder. Not for who makes hundreds of variants once.
  bool keep_kernels = true;
};

// Every device that can run taxelsim (Vulkan 1.2, compute queue), best first. Throws Error(kDevice) when there is no Vulkan at all.
std::vector<DeviceInfo> listDevices();

// Shared ownership of an open device; copies are handles to the same one. Safe to use from several threads.
class Device {
 public:
  // Throws Error(kDevice) when no device matches, naming what there is.
  static Device open(const DeviceOptions& options = {});

  const DeviceInfo& info() const;

 private:
  friend struct gpu::DeviceAccess;
  explicit Device(std::shared_ptr<gpu::Context> context) : context_(std::move(context)) {}
  std::shared_ptr<gpu::Context> context_;
};

}  // namespace taxelsim
