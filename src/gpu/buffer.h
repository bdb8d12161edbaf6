// A device buffer and its memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "gpu/context.h"

namespace taxelsim::gpu {

// Kind of memory, by use.
enum class Domain {
  kDevice,    // written and read by kernels; mapped where device memory is host-cached (CPU devices, many integrated ones)
  kUpload,    // written by the host, read by kernels or copied from; always mapped
  kReadback,  // written by copies, read by the host; always mapped
};

// Whether other interfaces may import the memory. kExported needs Context::exports().memory.
enum class Sharing { kPrivate, kExported };

// Memory of a buffer, for an importer. Each buffer has memory of its own, which begins with its first byte.
struct ExportedMemory {
  int descriptor;       // a new one, which the caller owns
  std::uint64_t bytes;  // size of the memory, at least that of the buffer
};

class Buffer {
 public:
  Buffer();
  // Filled with zeros. Throws Error(kDevice), naming buffer and size, when memory runs out.
  Buffer(Context& context, std::string name, std::size_t bytes, Domain domain, Sharing sharing = Sharing::kPrivate);
  ~Buffer();
  Buffer(Buffer&&) noexcept;
  Buffer& operator=(Buffer&&) noexcept;

  const std::string& name() const { return name_; }
  std::size_t size() const { return bytes_; }

  // The memory as the host sees it, coherent with the device after Commands::wait(); empty if it is not mapped.
  std::span<std::byte> mapped() const { return mapped_; }

  template <typename T>
  std::span<T> mappedAs() const {
    return {reinterpret_cast<T*>(mapped_.data()), mapped_.size() / sizeof(T)};
  }

  // Needs Sharing::kExported. Throws Error(kDevice) if the driver refuses.
  ExportedMemory exportMemory(Context& context) const;

  // Makes it readable as texels of four words; safe to call again and from several threads. Throws Error(kDevice) for more texels than the
  // device allows.
  void viewAsTexels(Context& context) const;

  struct Vulkan;
  Vulkan& vulkan() const { return *vulkan_; }

 private:
  std::unique_ptr<Vulkan> vulkan_;
  std::string name_;
  std::size_t bytes_ = 0;
  std::span<std::byte> mapped_;
};

// Writes the beginning of a buffer, which no kernel uses meanwhile. Waits.
void upload(Context& context, std::span<const std::byte> bytes, const Buffer& buffer);

// A device buffer with these contents. Waits for the upload.
Buffer makeStaticBuffer(Context& context, std::string name, std::span<const std::byte> bytes);

template <typename T>
Buffer makeStaticBuffer(Context& context, std::string name, std::span<const T> values) {
  return makeStaticBuffer(context, std::move(name), std::as_bytes(values));
}

}  // namespace taxelsim::gpu
