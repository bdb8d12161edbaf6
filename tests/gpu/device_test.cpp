// Choice of devices, and messages of device errors.
#include <sched.h>

#include "gpu/buffer.h"
#include "gpu/device_access.h"
#include "gpu/vulkan.h"
#include "support/plain.h"
#include "support/test.h"
#include "taxelsim/device.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

template <typename Call>
std::string deviceError(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kDevice);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
    return error.what();
  }
  ADD_FAILURE() << "nothing thrown";
  return "";
}

std::string nameOfThread(const std::filesystem::path& thread) {
  std::ifstream stream(thread / "comm");
  std::string name;
  std::getline(stream, name);
  return name;
}

cpu_set_t maskOf(pid_t thread) {
  cpu_set_t mask;
  CPU_ZERO(&mask);
  EXPECT_EQ(::sched_getaffinity(thread, sizeof(mask), &mask), 0);
  return mask;
}

// The processors to which one thread each of this process is bound, unlike the calling one.
std::multiset<int> boundProcessors() {
  const cpu_set_t all = maskOf(0);
  std::multiset<int> processors;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    const cpu_set_t mask = maskOf(std::stoi(thread.path().filename()));
    if (CPU_COUNT(&mask) != 1 || CPU_EQUAL(&mask, &all)) continue;
    EXPECT_THAT(nameOfThread(thread), testing::Not(testing::StartsWith("llvmpipe-"))) << "threads that draw compute nothing";
    for (int i = 0; i < CPU_SETSIZE; ++i) {
      if (CPU_ISSET(i, &mask)) processors.insert(i);
    }
  }
  return processors;
}

TEST(Devices, AreListedBestFirst) {
  const std::vector<DeviceInfo> infos = listDevices();
  ASSERT_FALSE(infos.empty());
  for (std::size_t i = 0; i < infos.size(); ++i) {
    EXPECT_EQ(infos[i].index, static_cast<int>(i));
    EXPECT_FALSE(infos[i].name.empty());
    EXPECT_GT(infos[i].memory, 0u);
    EXPECT_GE(infos[i].shared_memory, 16384u) << "Vulkan's minimum";
    if (i > 0) {
      EXPECT_LE(infos[i - 1].type, infos[i].type);
    }
  }
}

TEST(Devices, AreChosenByNumberNameAndKind) {
  const DeviceInfo first = listDevices().front();
  EXPECT_EQ(Device::open({.device = "0"}).info().name, first.name);
  EXPECT_EQ(Device::open({.device = first.name.substr(1, 4)}).info().name, first.name);
  if (first.type == DeviceType::kCpu) {
    EXPECT_EQ(Device::open({.device = "cpu"}).info().name, first.name);
  }
}

TEST(Devices, MesasDriverThreadsKeepToAProcessorEach) {
  const cpu_set_t mask = maskOf(0);
  const std::multiset<int> before = boundProcessors();
  const std::string name = nameOfThread("/proc/thread-self");
  {
    const support::Plain plain("threads");
    const Device device = Device::open();
    EXPECT_EQ(boundProcessors(), before);
  }
  {
    const Device device = Device::open(), another = Device::open();
    const char* num_threads = std::getenv("LP_NUM_THREADS");
    const bool has_one_each = num_threads == nullptr || std::atoi(num_threads) == CPU_COUNT(&mask);
    const bool binds =
        device.info().driver.starts_with("llvmpipe ") && CPU_COUNT(&mask) > 1 && has_one_each && !support::isSwitchedOff("threads");
    std::multiset<int> bound = before;
    for (int i = 0; i < CPU_SETSIZE; ++i) {
      if (!binds || !CPU_ISSET(i, &mask)) continue;
      for (int k = 0; k < 2; ++k) bound.insert(i);  // one thread of each device
    }
    EXPECT_EQ(boundProcessors(), bound);
    EXPECT_EQ(nameOfThread("/proc/thread-self"), name);
    const cpu_set_t mask_after = maskOf(0);
    EXPECT_TRUE(CPU_EQUAL(&mask, &mask_after)) << "the thread that opens a device stays free";
  }
  EXPECT_EQ(boundProcessors(), before) << "threads outlive their device";
}

TEST(Devices, AnUnknownOneIsAnErrorThatListsAll) {
  const std::string message = deviceError([] { Device::open({.device = "no such device"}); });
  EXPECT_THAT(message, AllOf(HasSubstr("no such device"), HasSubstr(listDevices().front().name)));
}

TEST(Devices, AreChosenByTheEnvironment) {
  ::setenv("TAXELSIM_DEVICE", "nothing like it", 1);
  const std::string message = deviceError([] { Device::open({}); });
  ::unsetenv("TAXELSIM_DEVICE");
  EXPECT_THAT(message, AllOf(HasSubstr("TAXELSIM_DEVICE"), HasSubstr("nothing like it")));
}

TEST(Devices, OutOfMemoryNamesBufferAndSize) {
  const Device device = Device::open({});
  // More than any device has. Without validation layers, which would report it first.
  const std::size_t bytes = std::size_t{1} << 46;
  const std::string message = deviceError([&] { gpu::Buffer(gpu::contextOf(device), "tactile_image", bytes, gpu::Domain::kDevice); });
  EXPECT_THAT(message, AllOf(HasSubstr("\"tactile_image\""), HasSubstr("67108864.0 MiB")));
}

TEST(Devices, ErrorsSayWhatWasDoneAndWhatToDo) {
  EXPECT_THAT(deviceError([] {
                gpu::throwDeviceError(vk::OutOfDeviceMemoryError("x"), "buffer \"features\" of 3.0 MiB", "use a smaller batch size");
              }),
              AllOf(HasSubstr("out of memory"), HasSubstr("\"features\" of 3.0 MiB"), HasSubstr("smaller batch size")));
  EXPECT_THAT(deviceError([] { gpu::throwDeviceError(vk::DeviceLostError("x"), "a frame", ""); }),
              AllOf(HasSubstr("lost"), HasSubstr("a frame"), HasSubstr("open it again")));
}

}  // namespace
}  // namespace taxelsim
