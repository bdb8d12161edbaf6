#include "interop/gpu.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <utility>

#include "base/log.h"
#include "taxelsim/error.h"

namespace taxelsim::interop {
namespace {

std::string hexadecimal(const Uuid& uuid) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : uuid) text += {kDigits[byte >> 4], kDigits[byte & 15]};
  return text;
}

// Gives a duplicate of the descriptor to `import(duplicate)`, which owns it if it succeeds, and closes the descriptor.
template <typename Import>
void importDescriptor(int descriptor, Import import) {
  const int duplicate = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
  const int problem = errno;
  ::close(descriptor);
  if (duplicate < 0) throw Error(ErrorKind::kDevice, std::string("importing memory of the device: ") + std::strerror(problem));
  try {
    import(duplicate);
  } catch (...) {
    ::close(duplicate);
    throw;
  }
}

// Runs what a destructor must do. Errors are logged only.
template <typename Call>
void release(Call call) {
  try {
    call();
  } catch (const std::exception& error) {
    logDebug(error.what());
  }
}

}  // namespace

std::shared_ptr<const Gpu> Gpu::open(Platform platform, const std::string& uuid) {
  const Driver& driver = driverOf(platform);
  int count = 0;
  driver.check(driver.countDevices(&count), "counting devices");
  std::string found;
  for (int ordinal = 0; ordinal < count; ++ordinal) {
    int device = 0;
    Uuid bytes{};
    driver.check(driver.device(&device, ordinal), "finding a device");
    driver.check(driver.uuid(&bytes, device), "reading a UUID");
    if (hexadecimal(bytes) == uuid) return std::shared_ptr<const Gpu>(new Gpu(driver, device, ordinal));
    found += (found.empty() ? "" : ", ") + hexadecimal(bytes);
  }
  throw Error(ErrorKind::kDevice, "the Vulkan device with UUID " + uuid + " is none of those that " +
                                      (platform == Platform::kCuda ? "CUDA (CUDA_VISIBLE_DEVICES)" : "HIP (HIP_VISIBLE_DEVICES)") +
                                      " shows: " + (found.empty() ? "none" : found));
}

Gpu::Gpu(const Driver& driver, int device, int ordinal) : driver_(driver), device_(device), ordinal_(ordinal) {
  driver_.check(driver_.retainContext(&context_, device_), "retaining the context");
}

Gpu::~Gpu() {
  driver_.releaseContext(device_);
}

template <typename Call>
void Gpu::inContext(Call call) const {
  driver_.check(driver_.pushContext(context_), "entering the context");
  const auto leave = [this] {
    Handle left = nullptr;
    driver_.popContext(&left);
  };
  try {
    call();
  } catch (...) {
    leave();
    throw;
  }
  leave();
}

void Gpu::synchronize(Stream stream) const {
  inContext([&] { driver_.check(driver_.synchronize(reinterpret_cast<Handle>(stream)), "waiting for a stream"); });
}

void Gpu::copyToHost(void* to, Address from, std::size_t bytes) const {
  inContext([&] { driver_.check(driver_.copyToHost(to, from, bytes), "copying to the host"); });
}

ImportedMemory::ImportedMemory(const Gpu& gpu, int descriptor, std::uint64_t bytes) : gpu_(&gpu) {
  const Driver& driver = gpu.driver_;
  importDescriptor(descriptor, [&](int duplicate) {
    gpu.inContext([&] {
      const MemoryHandle handle{kOpaqueDescriptor, 0, duplicate, {}, bytes, kDedicated, {}};
      driver.check(driver.importMemory(&memory_, &handle), "importing memory");
    });
  });
  try {
    gpu.inContext([&] {
      const MemoryRange range{0, bytes, 0, {}};
      driver.check(driver.mapMemory(&address_, memory_, &range), "mapping memory");
    });
  } catch (...) {
    driver.destroyMemory(memory_);
    throw;
  }
}

ImportedMemory::ImportedMemory(ImportedMemory&& other) noexcept
    : gpu_(other.gpu_), memory_(std::exchange(other.memory_, nullptr)), address_(other.address_) {}

ImportedMemory::~ImportedMemory() {
  if (memory_ == nullptr) return;
  release([this] {
    gpu_->inContext([this] {
      gpu_->driver_.unmapMemory(address_);
      gpu_->driver_.destroyMemory(memory_);
    });
  });
}

ImportedTimeline::ImportedTimeline(const Gpu& gpu, int descriptor) : gpu_(&gpu) {
  importDescriptor(descriptor, [&](int duplicate) {
    gpu.inContext([&] {
      const SemaphoreHandle handle{kTimelineDescriptor, 0, duplicate, {}, 0, {}};
      gpu.driver_.check(gpu.driver_.importSemaphore(&semaphore_, &handle), "importing a semaphore");
    });
  });
}

ImportedTimeline::ImportedTimeline(ImportedTimeline&& other) noexcept
    : gpu_(other.gpu_), semaphore_(std::exchange(other.semaphore_, nullptr)) {}

ImportedTimeline::~ImportedTimeline() {
  if (semaphore_ == nullptr) return;
  release([this] { gpu_->inContext([this] { gpu_->driver_.destroySemaphore(semaphore_); }); });
}

void ImportedTimeline::waitFor(std::uint64_t value, Stream stream) const {
  const SemaphorePoint point{value, {}};
  gpu_->inContext([&] {
    gpu_->driver_.check(gpu_->driver_.wait(&semaphore_, &point, 1, reinterpret_cast<Handle>(stream)), "waiting for a semaphore");
  });
}

void ImportedTimeline::signal(std::uint64_t value, Stream stream) const {
  const SemaphorePoint point{value, {}};
  gpu_->inContext([&] {
    gpu_->driver_.check(gpu_->driver_.signal(&semaphore_, &point, 1, reinterpret_cast<Handle>(stream)), "signalling a semaphore");
  });
}

}  // namespace taxelsim::interop
