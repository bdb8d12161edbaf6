// Questions that passes ask about drivers, for a GPU, for Mesa's software driver and for another one.
#include "gpu/driver_profile.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using gpu::DriverProfile;
using gpu::FastPaths;
using gpu::WideNumbers;

DriverProfile profileOf(DeviceType type, const char* driver, const FastPaths& paths = {},
                        const WideNumbers& wide_numbers = {.integers = true, .floats = true, .shared_atomics = true}) {
  DeviceInfo info;
  info.type = type;
  info.driver = driver;
  info.subgroup_size = 8;
  return {info, wide_numbers, paths};
}

const DriverProfile& lavapipe() {
  static const DriverProfile profile = profileOf(DeviceType::kCpu, "llvmpipe Mesa 22.3.6 (LLVM 15.0.6)");
  return profile;
}

const DriverProfile& discreteGpu() {
  static const DriverProfile profile = profileOf(DeviceType::kDiscrete, "a GPU's driver");
  return profile;
}

TEST(DriverProfile, WorkgroupsFollowTheWorkOnSoftwareDriversOnly) {
  EXPECT_EQ(lavapipe().workgroupFor(0), 8u);
  EXPECT_EQ(lavapipe().workgroupFor(12 * gpu::kMaxIterations), 16u);
  EXPECT_EQ(lavapipe().workgroupFor(10'000 * gpu::kMaxIterations), 256u);
  EXPECT_EQ(discreteGpu().workgroupFor(0), 64u);
  EXPECT_EQ(discreteGpu().workgroupFor(10'000 * gpu::kMaxIterations), 64u);
}

TEST(DriverProfile, NoInvocationExceedsTheLimitOfIterations) {
  EXPECT_TRUE(lavapipe().prefersOneInvocationPerItem(gpu::kMaxIterations));
  EXPECT_FALSE(lavapipe().prefersOneInvocationPerItem(gpu::kMaxIterations + 1));
  EXPECT_FALSE(discreteGpu().prefersOneInvocationPerItem(1));
  EXPECT_EQ(lavapipe().itemsInSequence(gpu::kMaxIterations / 3, 16), 3u);
  EXPECT_EQ(lavapipe().itemsInSequence(0, 16), 16u);
  EXPECT_EQ(lavapipe().itemsInSequence(2 * gpu::kMaxIterations, 16), 1u);
  EXPECT_EQ(discreteGpu().itemsInSequence(1, 16), 1u);
}

TEST(DriverProfile, LockstepNeedsMesasSoftwareDriverAndOneVector) {
  const std::uint32_t any = 1, lockstep = 2;
  const gpu::ShaderVariants variants{{&any, 1}, {&lockstep, 1}};
  EXPECT_EQ(lavapipe().select(variants, 8)[0], lockstep);
  EXPECT_EQ(lavapipe().select(variants, 16)[0], any);
  EXPECT_EQ(profileOf(DeviceType::kCpu, "SwiftShader driver").select(variants, 4)[0], any);
  EXPECT_EQ(discreteGpu().select(variants, 8)[0], any);
  EXPECT_EQ(profileOf(DeviceType::kCpu, "llvmpipe Mesa", {.lockstep = false}).select(variants, 8)[0], any);
  EXPECT_EQ(profileOf(DeviceType::kCpu, "llvmpipe Mesa", {}, {.integers = true, .floats = true}).select(variants, 8)[0], any);
}

TEST(DriverProfile, PlainPathsSwitchOffWhatTheyName) {
  EXPECT_TRUE(lavapipe().prefersTexels());
  EXPECT_FALSE(profileOf(DeviceType::kCpu, "llvmpipe Mesa", {.lockstep = false}).prefersTexels());
  EXPECT_FALSE(profileOf(DeviceType::kCpu, "llvmpipe Mesa", {.alone = false}).prefersOneInvocationPerItem(1));
}

TEST(DriverProfile, ServosRunOnGpusWithWideFloats) {
  EXPECT_TRUE(discreteGpu().prefersServosOnDevice());
  EXPECT_TRUE(lavapipe().canRunServos());
  EXPECT_FALSE(lavapipe().prefersServosOnDevice());
  EXPECT_FALSE(profileOf(DeviceType::kDiscrete, "a GPU's driver", {.servo = false}).prefersServosOnDevice());
  const DriverProfile narrow = profileOf(DeviceType::kDiscrete, "a GPU's driver", {}, {.integers = true, .floats = false});
  EXPECT_FALSE(narrow.canRunServos());
  EXPECT_FALSE(narrow.prefersServosOnDevice());
}

TEST(DriverProfile, OnlyDiscreteGpusCopyResults) {
  EXPECT_TRUE(discreteGpu().copiesResults());
  EXPECT_FALSE(lavapipe().copiesResults());
  EXPECT_FALSE(profileOf(DeviceType::kIntegrated, "a GPU's driver").copiesResults());
}

}  // namespace
}  // namespace taxelsim
