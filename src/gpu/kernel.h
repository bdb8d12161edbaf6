// A compute shader with its interface: what it expects is reflected from the SPIR-V and compared with what the caller declares, at
// creation.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gpu/context.h"

namespace taxelsim::gpu {

// Value of one specialization constant, by its constant_id.
struct Constant {
  std::uint32_t id = 0;
  std::uint32_t value = 0;
};

struct KernelOptions {
  std::string name;
  std::span<const std::uint32_t> spirv;  // must stay as long as the kernel
  // Block names of the storage buffers, names of the texel buffers, by binding, 0, 1, ...; all in set 0. Must be exactly those of the
  // shader.
  std::vector<std::string> buffers;
  std::vector<Constant> constants;
};

class Kernel {
 public:
  Kernel();
  // Has the driver compile it on a thread of its own. Throws std::logic_error when shader and declaration differ.
  Kernel(Context& context, const KernelOptions& options);
  ~Kernel();
  Kernel(Kernel&&) noexcept;
  Kernel& operator=(Kernel&&) noexcept;

  const std::string& name() const { return name_; }
  std::size_t numBuffers() const { return num_buffers_; }
  // Waits until it is compiled. Throws Error(kDevice) when the driver refuses.
  void wait() const;

  struct Vulkan;
  Vulkan& vulkan() const { return *vulkan_; }

 private:
  std::unique_ptr<Vulkan> vulkan_;
  std::string name_;
  std::size_t num_buffers_ = 0;
};

}  // namespace taxelsim::gpu
