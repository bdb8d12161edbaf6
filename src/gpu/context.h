// An open Vulkan device with one compute queue, which everything in this folder belongs to. The headers that other folders include show no
// Vulkan type.
#pragma once

#include <memory>

#include "taxelsim/device.h"

namespace taxelsim::gpu {

class Context {
 public:
  explicit Context(const DeviceOptions& options);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const DeviceInfo& info() const { return info_; }

  // Whether kernels may use 64-bit integers.
  bool hasInt64() const { return has_int64_; }

  // Writes the pipeline cache to disk if there are new pipelines and DeviceOptions::keep_kernels. Errors are logged only.
  void savePipelineCache();

  // Throws Error(kDevice) with the first validation message since the last call, if there was any.
  void throwOnValidationMessage();

  struct Vulkan;  // gpu/vulkan.h
  Vulkan& vulkan() { return *vulkan_; }

 private:
  std::unique_ptr<Vulkan> vulkan_;
  DeviceInfo info_;
  bool has_int64_ = false;
  bool keeps_kernels_ = true;
};

}  // namespace taxelsim::gpu
