// Threads of the CPU peers.
#pragma once

#include <immintrin.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace taxelsim::bench {

// 0: one per core.
inline int threadsOf(int requested) {
  return requested > 0 ? requested : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

// Calls `work(thread, instance)` in `num_threads` threads, which take blocks of instances from a shared counter; joins them.
template <typename Work>
void inThreads(int num_threads, int num_instances, int block, const Work& work) {
  std::atomic<int> next{0};
  const auto loop = [&](int thread) {
    // Recommended by Embree's manual; applied to all peers.
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    for (int begin; (begin = next.fetch_add(block)) < num_instances;) {
      for (int i = begin; i < std::min(begin + block, num_instances); ++i) work(thread, i);
    }
  };
  std::vector<std::jthread> threads;
  for (int t = 0; t < num_threads; ++t) threads.emplace_back(loop, t);
}

}  // namespace taxelsim::bench
