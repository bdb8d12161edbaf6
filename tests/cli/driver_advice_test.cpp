// Drivers for which a faster one is recommended.
#include "cli/driver_advice.h"
#include "support/test.h"

namespace taxelsim::cli {
namespace {

std::string adviceFor(const std::string& driver) {
  DeviceInfo device;
  device.index = 2;
  device.driver = driver;
  return driverAdvice(device);
}

TEST(DriverAdvice, OldLavapipeAlone) {
  EXPECT_EQ(adviceFor("llvmpipe Mesa 22.3.6 (LLVM 15.0.6)").find("device 2: "), 0u);
  EXPECT_EQ(adviceFor("llvmpipe Mesa 25.0.7-2~bpo12+1 (LLVM 15.0.6)"), "");
  EXPECT_EQ(adviceFor("llvmpipe Mesa 26.1.0 (LLVM 19.1.0)"), "");
  EXPECT_EQ(adviceFor("llvmpipe"), "");
  EXPECT_EQ(adviceFor("radv Mesa 22.3.6"), "");
  EXPECT_EQ(adviceFor("NVIDIA 550.54"), "");
}

}  // namespace
}  // namespace taxelsim::cli
