/// @file
/// A Vulkan device, opened for compute. Not a wrapper for Vulkan: no Vulkan type is visible here.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace taxelsim {

/// @cond
namespace gpu {
class Context;
struct DeviceAccess;
}  // namespace gpu
/// @endcond

/// Type of a device, as its driver reports it.
enum class DeviceType {
  kDiscrete,    ///< GPU with its own memory.
  kIntegrated,  ///< GPU that shares the host's memory.
  kVirtual,     ///< Virtual GPU.
  kCpu,         ///< Software Vulkan on the processor.
  kOther,       ///< None of these.
};

/// Description of a device.
struct DeviceInfo {
  int index = 0;                         ///< Position in listDevices(), from 0.
  std::string name;                      ///< Name that the driver gives the device.
  DeviceType type = DeviceType::kOther;  ///< Type that the driver reports.
  std::string driver;                    ///< Name and version of the driver, as it reports them.
  std::string api_version;               ///< Vulkan version, "1.3.230".
  std::string uuid;                      ///< UUID of the device, hexadecimal.
  std::uint64_t memory = 0;              ///< Bytes of the largest device-local heap.
  std::uint64_t max_buffer = 0;          ///< Bytes that one storage buffer can hold.
  std::uint32_t subgroup_size = 0;       ///< Invocations of a subgroup.
  std::uint32_t shared_memory = 0;       ///< Bytes of shared memory per workgroup.
};

/// Name and driver of a device, as data sets and evaluations record them.
inline std::string deviceText(const DeviceInfo& info) {
  return info.name + ", " + info.driver;
}

/// Options of Device::open().
struct DeviceOptions {
  /// "gpu" (the best that is not a CPU), "discrete", "integrated", "cpu", an index into listDevices(), or part of a device's name. Empty
  /// (default): the value of the environment variable TAXELSIM_DEVICE if set, else the first of listDevices().
  std::string device{};
  /// Enables core and synchronisation validation; TAXELSIM_VALIDATION=1 enables it too. After a validation message, the next wait throws
  /// Error(kDevice). Default false.
  bool validation = false;
  /// Stores compiled kernels in the user's cache folder for later processes. Default true. Disable it when creating hundreds of models
  /// once, as a benchmark does.
  bool keep_kernels = true;
};

/// Lists all devices that can run taxelsim: Vulkan 1.2 with a compute queue.
///
/// The best comes first: discrete, integrated, virtual, CPU. Throws Error(kDevice) when there is no Vulkan at all.
std::vector<DeviceInfo> listDevices();

/// An open device. A copy is a handle to the same device, which closes with its last handle; a Model holds one.
///
/// Threads: may be used from several threads at once. Submissions are serialised by a lock. Do not fork() while a device is open.
///
/// The library does not change the environment of its process. open() binds each thread that Mesa's software driver computes with to a
/// processor of the calling thread's affinity mask, if there is one such thread per processor (docs/how_to/drivers.md); the caller's
/// threads stay free.
class Device {
 public:
  /// Opens a device. Waits.
  ///
  /// Throws Error(kDevice) when no device matches, with a list of those that exist, and when validation is requested but its layers are not
  /// installed; Error(kInput) for an unknown name in the environment variable TAXELSIM_PLAIN (docs/notes/performance.md).
  static Device open(const DeviceOptions& options = {});

  /// Description of the device; valid as long as any handle.
  const DeviceInfo& info() const;

 private:
  friend struct gpu::DeviceAccess;
  explicit Device(std::shared_ptr<gpu::Context> context) : context_(std::move(context)) {}
  std::shared_ptr<gpu::Context> context_;
};

}  // namespace taxelsim
