// Reflection of shaders, and the comparison of a kernel with its declaration.
#include <sys/resource.h>

#include <csignal>

#include "elastic_layer.spv.h"
#include "elastic_layer_lockstep.spv.h"
#include "find_candidates.spv.h"
#include "find_candidates_lockstep.spv.h"
#include "gpu/device_access.h"
#include "gpu/kernel.h"
#include "gpu/reflection.h"
#include "load.spv.h"
#include "support/temporary_directory.h"
#include "support/test.h"
#include "taxelsim/device.h"

namespace taxelsim {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

gpu::KernelOptions loadKernel() {
  constexpr std::uint32_t kNumConstants = 14;
  gpu::KernelOptions options{
      .name = "load", .spirv = k_load_spirv, .buffers = {"Instances", "Step", "TileResults", "Loads"}, .constants = {}};
  for (std::uint32_t id = 0; id < kNumConstants; ++id) options.constants.push_back({id, 1});
  return options;
}

std::string refusal(const gpu::KernelOptions& options) {
  const Device device = Device::open({});
  try {
    gpu::Kernel(gpu::contextOf(device), options);
  } catch (const std::logic_error& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing thrown";
  return "";
}

TEST(KernelOnEveryDriver, ReflectsBuffersAndConstants) {
  const gpu::Reflection reflection = gpu::reflect(k_load_spirv);
  EXPECT_THAT(reflection.buffers, ElementsAre(Pair(0, "Instances"), Pair(1, "Step"), Pair(2, "TileResults"), Pair(3, "Loads")));
  EXPECT_THAT(reflection.constants, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13));
  EXPECT_THAT(reflection.uniform_buffers, ElementsAre(1)) << "step";
  EXPECT_TRUE(reflection.texel_buffers.empty());
  EXPECT_TRUE(reflection.others.empty());
}

TEST(KernelOnEveryDriver, ReflectsTexelBuffersByName) {
  const gpu::Reflection any = gpu::reflect(k_find_candidates_spirv), lockstep = gpu::reflect(k_find_candidates_lockstep_spirv);
  EXPECT_EQ(lockstep.buffers, any.buffers);
  EXPECT_THAT(any.texel_buffers, IsEmpty());
  EXPECT_THAT(lockstep.texel_buffers, ElementsAre(0, 2, 3, 4, 5, 6)) << "poses, objects, groups, clusters, quads, patches";
  EXPECT_THAT(lockstep.others, IsEmpty());
}

TEST(KernelOnEveryDriver, ReflectsStorageTexelBuffersByName) {
  const gpu::Reflection any = gpu::reflect(k_elastic_layer_spirv), lockstep = gpu::reflect(k_elastic_layer_lockstep_spirv);
  EXPECT_EQ(lockstep.buffers, any.buffers);
  EXPECT_THAT(any.storage_texel_buffers, IsEmpty());
  EXPECT_THAT(lockstep.storage_texel_buffers, ElementsAre(20)) << "strips of the layer";
  EXPECT_THAT(lockstep.texel_buffers, ElementsAre(0, 3, 5, 14)) << "instances, heights, influence, motions";
  EXPECT_THAT(lockstep.others, IsEmpty());
}

TEST(KernelOnEveryDriver, BuildsADeclaredShader) {
  const Device device = Device::open({});
  const gpu::Kernel kernel(gpu::contextOf(device), loadKernel());
  kernel.wait();
  EXPECT_EQ(kernel.numBuffers(), 4u);
}

// In a child process, since the environment of this one must not change.
TEST(KernelOnEveryDriver, IsCachedOnDiskOnlyOnRequest) {
  for (const bool keep : {false, true}) {
    const testing::TemporaryDirectory cache;
    const auto run = [&] {
      setenv("XDG_CACHE_HOME", cache.path().c_str(), 1);
      const Device device = Device::open({.keep_kernels = keep});
      const gpu::Kernel kernel(gpu::contextOf(device), loadKernel());
      kernel.wait();
      gpu::contextOf(device).savePipelineCache();
      std::_Exit(std::filesystem::exists(cache / "taxelsim") == keep ? 0 : 1);
    };
    EXPECT_EXIT(run(), ::testing::ExitedWithCode(0), "") << keep;
  }
}

// A limit on the size of files stands for a full disk.
TEST(KernelOnEveryDriver, LeavesNoPartialCacheOnAFullDisk) {
  const testing::TemporaryDirectory cache;
  const auto run = [&] {
    setenv("XDG_CACHE_HOME", cache.path().c_str(), 1);
    const Device device = Device::open({.keep_kernels = true});
    const gpu::Kernel kernel(gpu::contextOf(device), loadKernel());
    kernel.wait();
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{16, 16};  // bytes
    setrlimit(RLIMIT_FSIZE, &limit);
    gpu::contextOf(device).savePipelineCache();
    std::_Exit(std::filesystem::is_empty(cache / "taxelsim") ? 0 : 1);
  };
  EXPECT_EXIT(run(), ::testing::ExitedWithCode(0), "");
}

TEST(KernelOnEveryDriver, RejectsWrongNamesAndNumbers) {
  gpu::KernelOptions swapped = loadKernel();
  std::swap(swapped.buffers[1], swapped.buffers[2]);
  EXPECT_THAT(refusal(swapped), HasSubstr("binding 1 is declared as \"TileResults\", the shader has \"Step\""));
  gpu::KernelOptions fewer = loadKernel();
  fewer.buffers.pop_back();
  EXPECT_THAT(refusal(fewer), HasSubstr("the shader has 4 buffers, 3 are declared"));
  gpu::KernelOptions more = loadKernel();
  more.buffers.emplace_back("State");
  EXPECT_THAT(refusal(more), HasSubstr("\"State\", the shader has nothing"));
  gpu::KernelOptions unknown = loadKernel();
  unknown.constants[2].id = 70;
  EXPECT_THAT(refusal(unknown), HasSubstr("specialization constants"));
}

TEST(KernelOnEveryDriver, RejectsInvalidModules) {
  const std::uint32_t words[] = {1, 2, 3, 4, 5, 6};
  EXPECT_THROW(gpu::reflect(words), std::logic_error);
}

}  // namespace
}  // namespace taxelsim
