#include "cli/driver_advice.h"

#include <charconv>
#include <string_view>

namespace taxelsim::cli {
namespace {

// Oldest measured lavapipe that does not split shared memory and buffer loads into lanes, and its gain over 22.3.6. docs/how_to/drivers.md
// lists the measured cases.
constexpr int kFastMesa = 25;
constexpr const char* kGain = "1.04 to 1.66";

// Major version of Mesa in the driver's description; 0 if there is none.
int majorOfMesa(std::string_view driver) {
  constexpr std::string_view kMesa = "Mesa ";
  const std::size_t at = driver.find(kMesa);
  if (at == std::string_view::npos) return 0;
  const std::string_view version = driver.substr(at + kMesa.size());
  int major = 0;
  std::from_chars(version.data(), version.data() + version.size(), major);
  return major;
}

}  // namespace

std::string driverAdvice(const DeviceInfo& device) {
  if (!device.driver.starts_with("llvmpipe")) return {};
  const int major = majorOfMesa(device.driver);
  if (major == 0 || major >= kFastMesa) return {};
  return "device " + std::to_string(device.index) + ": lavapipe of Mesa " + std::to_string(kFastMesa) + " computes " + kGain +
         " times as many frames/s as this driver; scripts/newer_mesa unpacks it (docs/how_to/drivers.md)";
}

}  // namespace taxelsim::cli
