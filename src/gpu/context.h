// An open Vulkan device with one compute queue, which everything in this folder belongs to. The headers that other folders include show no
// Vulkan type.
#pragma once

#include <memory>

#include "taxelsim/device.h"

namespace taxelsim::gpu {

// Numbers of 64 bits that kernels may use.
struct WideNumbers {
  bool integers = false;
  bool floats = false;
  bool shared_atomics = false;  // atomic operations on integers of 64 bits in shared memory
};

// Objects that the device can hand to other interfaces of the machine as descriptors.
struct Exports {
  bool memory = false;     // Buffer::exportMemory()
  bool timelines = false;  // Timeline::exportDescriptor()
};

class Context {
 public:
  explicit Context(const DeviceOptions& options);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const DeviceInfo& info() const { return info_; }

  const WideNumbers& wideNumbers() const { return wide_numbers_; }

  const Exports& exports() const { return exports_; }

  // Writes the pipeline cache to disk if there are new pipelines and DeviceOptions::keep_kernels. Errors are logged only.
  void savePipelineCache();

  // Throws Error(kDevice) with the first validation message since the last call, if there was any.
  void throwOnValidationMessage();

  struct Vulkan;  // gpu/vulkan.h
  Vulkan& vulkan() { return *vulkan_; }

 private:
  void openDevice();  // the physical device that was chosen

  std::unique_ptr<Vulkan> vulkan_;
  DeviceInfo info_;
  WideNumbers wide_numbers_;
  Exports exports_;
  bool keeps_kernels_ = true;
};

}  // namespace taxelsim::gpu
