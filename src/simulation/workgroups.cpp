#include "simulation/workgroups.h"

#include <algorithm>
#include <string>

#include "taxelsim/error.h"

namespace taxelsim {

std::uint32_t chooseWorkgroup(int wanted, const DeviceInfo& info, std::uint32_t on_gpu, std::uint64_t work, const char* name) {
  if (wanted == 0 && info.type == DeviceType::kCpu) {
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(std::bit_ceil(work / kMaxTurns), 8, 256));
  }
  if (wanted == 0) return on_gpu;
  if (wanted < 4 || wanted > 256 || !std::has_single_bit(static_cast<unsigned>(wanted))) {
    throw Error(ErrorKind::kInput, std::string(name) + ": " + std::to_string(wanted) + " is not allowed: a power of two, 4 to 256");
  }
  return static_cast<std::uint32_t>(wanted);
}

std::uint32_t chooseRepeat(const DeviceInfo& info, std::uint64_t turns, std::uint32_t most) {
  if (info.type != DeviceType::kCpu) return 1;
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(kMaxTurns / std::max<std::uint64_t>(turns, 1), 1, most));
}

}  // namespace taxelsim
