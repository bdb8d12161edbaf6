#include "simulation/host_threads.h"

#include <algorithm>

#include "base/processors.h"

namespace taxelsim {

int hostThreads(DeviceType device, int num_instances) {
  constexpr int kMost = 8, kLeastInstances = 512;
  if (device == DeviceType::kCpu) return 1;
  return std::clamp(std::min(usableProcessors() / 2, num_instances / kLeastInstances), 1, kMost);
}

}  // namespace taxelsim
