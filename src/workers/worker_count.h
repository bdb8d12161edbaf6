// How many processes share a run.
#pragma once

#include <cstdint>

#include "taxelsim/device.h"

namespace taxelsim::workers {

inline constexpr std::uint64_t kMinEpisodes = 4096;           // fewer are not worth the start of a process
inline constexpr std::uint64_t kMinEpisodesPerWorker = 1024;  // seconds of one processor
inline constexpr int kMaxWorkers = 1024;

// Processes, with this one, for a run of so many episodes: on a device of software one for each of `num_processors`, else 1. A software
// driver with several threads lets them wait for each other at every barrier.
int defaultWorkers(const DeviceInfo& device, std::uint64_t num_episodes, int num_processors);

// The part of the instances of a batch that each of the processes simulates, at least 1.
int batchShare(int batch_size, int num_processes);

}  // namespace taxelsim::workers
