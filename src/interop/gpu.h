// A GPU in CUDA, or in HIP, which is untested: memory and semaphores that Vulkan has exported are imported there. Takes plain values only:
// descriptors, sizes, the UUID of the device.
//
// Threads: any, at once. The caller's context of the driver stays as it is. After fork() nothing here may be used or destroyed in the
// child.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "interop/driver.h"

namespace taxelsim::interop {

// A stream of work on the GPU, as DLPack names it: 1 the legacy default stream, 2 the default stream of the thread, else a pointer.
using Stream = std::uintptr_t;

class Gpu;

// Imported memory. Its GPU must outlive it.
class ImportedMemory {
 public:
  ImportedMemory(const Gpu& gpu, int descriptor, std::uint64_t bytes);
  ImportedMemory(ImportedMemory&& other) noexcept;
  ImportedMemory& operator=(ImportedMemory&&) = delete;
  ~ImportedMemory();

  Address address() const { return address_; }

 private:
  const Gpu* gpu_;
  Handle memory_ = nullptr;
  Address address_ = 0;
};

// An imported timeline semaphore. Its GPU must outlive it.
class ImportedTimeline {
 public:
  ImportedTimeline(const Gpu& gpu, int descriptor);
  ImportedTimeline(ImportedTimeline&& other) noexcept;
  ImportedTimeline& operator=(ImportedTimeline&&) = delete;
  ~ImportedTimeline();

  // Work that is put on the stream from now on begins when the timeline has reached `value`. Does not wait.
  void waitFor(std::uint64_t value, Stream stream) const;
  // The timeline gets `value` when all work of the stream so far has ended. Does not wait.
  void signal(std::uint64_t value, Stream stream) const;

 private:
  const Gpu* gpu_;
  Handle semaphore_ = nullptr;
};

class Gpu {
 public:
  // The device of this UUID, hexadecimal, whatever its number is. Throws Error(kDevice) without the driver or such a device.
  static std::shared_ptr<const Gpu> open(Platform platform, const std::string& uuid);
  ~Gpu();
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  // The number that the driver gives the GPU in this process.
  int ordinal() const { return ordinal_; }

  // Each takes the descriptor, which is closed or the driver's afterwards, also after an error. Throws Error(kDevice).
  // `bytes`: of the memory, which is dedicated to one buffer.
  ImportedMemory importMemory(int descriptor, std::uint64_t bytes) const { return {*this, descriptor, bytes}; }
  ImportedTimeline importTimeline(int descriptor) const { return {*this, descriptor}; }

  // Waits on the host for the work of a stream.
  void synchronize(Stream stream) const;
  // Copies to memory of the host. Waits.
  void copyToHost(void* to, Address from, std::size_t bytes) const;

 private:
  friend ImportedMemory;
  friend ImportedTimeline;
  Gpu(const Driver& driver, int device, int ordinal);
  // Runs `call` in the context that the frameworks use.
  template <typename Call>
  void inContext(Call call) const;

  const Driver& driver_;
  int device_;
  int ordinal_;
  Handle context_ = nullptr;
};

}  // namespace taxelsim::interop
