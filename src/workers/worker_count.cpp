#include "workers/worker_count.h"

#include <algorithm>

namespace taxelsim::workers {

int defaultWorkers(const DeviceInfo& device, std::uint64_t num_episodes, int num_processors) {
  if (device.type != DeviceType::kCpu || num_episodes < kMinEpisodes) return 1;
  const std::uint64_t most = std::min<std::uint64_t>(num_episodes / kMinEpisodesPerWorker, kMaxWorkers);
  return std::min(std::max(num_processors, 1), static_cast<int>(most));
}

int batchShare(int batch_size, int num_processes) {
  return std::max(1, batch_size / num_processes);
}

}  // namespace taxelsim::workers
