#include "workers/worker_count.h"

#include <gtest/gtest.h>

namespace taxelsim::testing {
namespace {

using namespace workers;

TEST(DefaultWorkers, AreOnePerProcessorOnADeviceOfSoftware) {
  DeviceInfo device;
  device.type = DeviceType::kCpu;
  EXPECT_EQ(defaultWorkers(device, 4096, 2), 2);
  EXPECT_EQ(defaultWorkers(device, 4096, 1), 1);
  EXPECT_EQ(defaultWorkers(device, 4095, 2), 1) << "too few episodes";
  EXPECT_EQ(defaultWorkers(device, 1'000'000, 64), 64);
  EXPECT_EQ(defaultWorkers(device, 1'000'000'000, 100'000), kMaxWorkers);
  EXPECT_EQ(defaultWorkers(device, 8192, 64), 8) << "each has 1,024 episodes at least";
  device.type = DeviceType::kDiscrete;
  EXPECT_EQ(defaultWorkers(device, 1'000'000, 64), 1);
}

TEST(BatchShare, IsOneAtLeast) {
  EXPECT_EQ(batchShare(2048, 2), 1024);
  EXPECT_EQ(batchShare(2048, 3), 682);
  EXPECT_EQ(batchShare(2, 3), 1);
}

}  // namespace
}  // namespace taxelsim::testing
