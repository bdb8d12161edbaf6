// A compiled compute shader. Its interface is reflected from the SPIR-V and must be the declared one.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gpu/context.h"
#include "gpu/specialization.h"

namespace taxelsim::gpu {

struct KernelOptions {
  std::string name;
  std::span<const std::uint32_t> spirv;  // must outlive the kernel
  std::vector<std::string> buffers;      // of set 0 by binding: names of blocks and texel buffers; must be all that the shader has
  std::vector<Constant> constants;       // must be all that the shader has
};

class Kernel {
 public:
  Kernel();
  // Starts the compilation in another thread. Throws std::logic_error when shader and declaration differ.
  Kernel(Context& context, const KernelOptions& options);
  ~Kernel();
  Kernel(Kernel&&) noexcept;
  Kernel& operator=(Kernel&&) noexcept;

  const std::string& name() const { return name_; }
  std::size_t numBuffers() const { return num_buffers_; }
  // Waits until it is compiled. Throws Error(kDevice) when the driver refuses it.
  void wait() const;

  struct Vulkan;
  Vulkan& vulkan() const { return *vulkan_; }

 private:
  std::unique_ptr<Vulkan> vulkan_;
  std::string name_;
  std::size_t num_buffers_ = 0;
};

}  // namespace taxelsim::gpu
