// An open Vulkan device with one compute queue: the root of everything in this folder. Knows nothing of tactile sensing, and its headers
// show no Vulkan type, so that the layers above compile without it.
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

  // Whether kernels may use integers of 64 bits; switched on where the device has them.
  bool hasInt64() const { return has_int64_; }

  // Writes the pipeline cache to disk if new pipelines were made and are to be kept; called by the owner of the last pipeline of a batch of
  // them. Errors are logged only: a cache is never worth a failure.
  void savePipelineCache();

  // Throws Error(kDevice) with the first validation message since the last call, if there was any.
  void throwOnValidationMessage();

  struct Vulkan;  // gpu/vulkan.h, for this folder alone
  Vulkan& vulkan() { return *vulkan_; }

 private:
  std::unique_ptr<Vulkan> vulkan_;
  DeviceInfo info_;
  bool has_int64_ = false;
  bool keeps_kernels_ = true;
};

}  // namespace taxelsim::gpu
