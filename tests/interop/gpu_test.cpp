// Memory that Vulkan exports, imported by a stand-in for the driver of a GPU: descriptors, lifetimes, every failure, streams, threads.
#include "interop/gpu.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <thread>

#include "gpu/buffer.h"
#include "gpu/device_access.h"
#include "support/test.h"
#include "taxelsim/device.h"
#include "taxelsim/error.h"

namespace taxelsim::interop {
namespace {

using ::testing::HasSubstr;

const Device& device() {
  static const Device opened = Device::open({.device = "cpu", .validation = true});
  return opened;
}
gpu::Context& context() {
  return gpu::contextOf(device());
}

// The library behind a platform, with the device of the test as its second one.
class Standin {
 public:
  explicit Standin(const char* file) : library_(::dlopen(file, RTLD_NOW)) {
    if (library_ == nullptr) throw std::runtime_error(::dlerror());
    std::array<Uuid, 2> devices{};
    for (std::size_t i = 0; i < 16; ++i) {
      devices[1][i] = static_cast<std::uint8_t>(std::stoi(device().info().uuid.substr(2 * i, 2), nullptr, 16));
    }
    call<void(const Uuid*, int)>("standinSetDevices")(devices.data(), 2);
  }
  template <typename Function>
  Function* call(const char* name) const {
    return reinterpret_cast<Function*>(::dlsym(library_, name));
  }
  void fail(const char* name) const { call<void(const char*)>("standinFail")(name); }
  int numHeld() const { return call<int()>("standinNumHeld")(); }
  int numEntered() const { return call<int()>("standinNumEntered")(); }
  std::string events() const { return call<const char*()>("standinEvents")(); }

 private:
  void* library_;
};

const Standin& cuda() {
  static const Standin library(TAXELSIM_STANDIN_CUDA);
  return library;
}

std::size_t numDescriptors() {
  const std::filesystem::directory_iterator open("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(open), end(open)));
}

gpu::Buffer makeBuffer() {
  return {context(), "shared", 5000, gpu::Domain::kDevice, gpu::Sharing::kExported};
}

std::uint8_t* bytesAt(const ImportedMemory& memory) {
  return reinterpret_cast<std::uint8_t*>(memory.address());
}

TEST(ImportedMemory, IsTheMemoryOfTheBuffer) {
  cuda();
  makeBuffer();  // opens the device
  const std::size_t before = numDescriptors();
  {
    const gpu::Buffer buffer = makeBuffer();
    const std::shared_ptr<const Gpu> gpu = Gpu::open(Platform::kCuda, device().info().uuid);
    EXPECT_EQ(gpu->ordinal(), 1);
    const gpu::ExportedMemory exported = buffer.exportMemory(context());
    EXPECT_GE(exported.bytes, 5000u);
    ImportedMemory first = gpu->importMemory(exported.descriptor, exported.bytes);
    const ImportedMemory memory = std::move(first);
    buffer.mapped()[4999] = std::byte{7};
    EXPECT_EQ(bytesAt(memory)[4999], 7);
    bytesAt(memory)[0] = 8;
    EXPECT_EQ(buffer.mapped()[0], std::byte{8});
    std::array<std::uint8_t, 5000> copy{};
    gpu->copyToHost(copy.data(), memory.address(), copy.size());
    EXPECT_EQ(copy[0], 8);
    EXPECT_EQ(copy[4999], 7);
  }
  EXPECT_EQ(cuda().numHeld(), 0);
  EXPECT_EQ(cuda().numEntered(), 0);
  EXPECT_EQ(numDescriptors(), before);
}

TEST(ImportedMemory, OutlivesTheBufferThatWasExported) {
  cuda();
  const std::shared_ptr<const Gpu> gpu = Gpu::open(Platform::kCuda, device().info().uuid);
  gpu::Buffer buffer = makeBuffer();
  const gpu::ExportedMemory exported = buffer.exportMemory(context());
  const ImportedMemory memory = gpu->importMemory(exported.descriptor, exported.bytes);
  buffer.mapped()[1] = std::byte{9};
  buffer = {};
  EXPECT_EQ(bytesAt(memory)[1], 9);
}

// Each call fails in turn while memory is imported and while it is released.
TEST(ImportedMemory, LeaksNothingWhenACallFails) {
  cuda();
  const gpu::Buffer buffer = makeBuffer();
  const std::size_t before = numDescriptors();
  for (const char* call : {"countDevices", "device", "uuid", "retainContext", "pushContext", "importMemory", "mapMemory"}) {
    SCOPED_TRACE(call);
    cuda().fail(call);
    try {
      const std::shared_ptr<const Gpu> gpu = Gpu::open(Platform::kCuda, device().info().uuid);
      const gpu::ExportedMemory exported = buffer.exportMemory(context());
      const ImportedMemory memory = gpu->importMemory(exported.descriptor, exported.bytes);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kDevice);
      EXPECT_THAT(error.what(), HasSubstr("failed with 1: as the test wished"));
    }
    cuda().fail("");
    EXPECT_EQ(cuda().numHeld(), 0);
    EXPECT_EQ(cuda().numEntered(), 0);
    EXPECT_EQ(numDescriptors(), before);
  }
}

TEST(ImportedMemory, ComesFromManyThreads) {
  cuda();
  const std::size_t before = numDescriptors();
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([] {
      const std::shared_ptr<const Gpu> gpu = Gpu::open(Platform::kCuda, device().info().uuid);
      for (int k = 0; k < 50; ++k) {
        const gpu::Buffer buffer = makeBuffer();
        const gpu::ExportedMemory exported = buffer.exportMemory(context());
        const ImportedMemory memory = gpu->importMemory(exported.descriptor, exported.bytes);
        buffer.mapped()[3] = static_cast<std::byte>(k);
        ASSERT_EQ(bytesAt(memory)[3], k);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(cuda().numHeld(), 0);
  EXPECT_EQ(numDescriptors(), before);
}

TEST(Gpu, IsFoundByItsUuidAlone) {
  cuda();
  try {
    Gpu::open(Platform::kCuda, std::string(32, 'a'));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("UUID " + std::string(32, 'a')));
    EXPECT_THAT(error.what(), HasSubstr("CUDA_VISIBLE_DEVICES"));
    EXPECT_THAT(error.what(), HasSubstr(device().info().uuid));
  }
  EXPECT_EQ(cuda().numHeld(), 0);
}

TEST(Gpu, HasTheSameCallsUnderTheNamesOfHip) {
  const Standin hip(TAXELSIM_STANDIN_HIP);
  {
    const gpu::Buffer buffer = makeBuffer();
    const std::shared_ptr<const Gpu> gpu = Gpu::open(Platform::kHip, device().info().uuid);
    const gpu::ExportedMemory exported = buffer.exportMemory(context());
    const ImportedMemory memory = gpu->importMemory(exported.descriptor, exported.bytes);
    EXPECT_EQ(hip.numHeld(), 3);
    EXPECT_EQ(cuda().numHeld(), 0);
  }
  EXPECT_EQ(hip.numHeld(), 0);
}

TEST(ImportedTimeline, TellsStreamsWhatToWaitForAndToSignal) {
  const std::size_t before = (cuda(), numDescriptors());
  {
    const std::shared_ptr<const Gpu> gpu = Gpu::open(Platform::kCuda, device().info().uuid);
    ImportedTimeline first = gpu->importTimeline(::memfd_create("timeline", MFD_CLOEXEC));
    const ImportedTimeline timeline = std::move(first);
    cuda().events();
    timeline.waitFor(6, 2);
    timeline.signal(7, 0x1234);
    EXPECT_EQ(cuda().events(), "wait 6 2\nsignal 7 4660\n");
    cuda().fail("signal");
    EXPECT_THROW(timeline.signal(8, 1), Error);
    cuda().fail("");
    EXPECT_EQ(cuda().numEntered(), 0);
  }
  EXPECT_EQ(cuda().numHeld(), 0);
  EXPECT_EQ(numDescriptors(), before);
}

TEST(ImportedTimeline, ClosesItsDescriptorWhenItIsRefused) {
  cuda();
  const std::shared_ptr<const Gpu> gpu = Gpu::open(Platform::kCuda, device().info().uuid);
  const std::size_t before = numDescriptors();
  cuda().fail("importSemaphore");
  EXPECT_THROW(gpu->importTimeline(::memfd_create("timeline", MFD_CLOEXEC)), Error);
  cuda().fail("");
  EXPECT_EQ(numDescriptors(), before);
}

}  // namespace
}  // namespace taxelsim::interop
