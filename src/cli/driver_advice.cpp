#include "cli/driver_advice.h"

#include "base/mesa_version.h"

namespace taxelsim::cli {
namespace {

// The oldest lavapipe whose shared memory and buffer loads are not taken apart lane by lane, of those that were measured.
constexpr int kFastMesa = 25;

}  // namespace

std::string driverAdvice(const DeviceInfo& device) {
  if (!device.driver.starts_with("llvmpipe")) return {};
  const int major = majorOfMesa(device.driver);
  if (major == 0 || major >= kFastMesa) return {};
  return "device " + std::to_string(device.index) + ": lavapipe of Mesa " + std::to_string(kFastMesa) +
         " is faster than this one; docs/drivers.md says by how much and how to get it";
}

}  // namespace taxelsim::cli
