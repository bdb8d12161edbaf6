// The threads of the peers that run on the CPU.
#pragma once

#include <immintrin.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace taxelsim::bench {

// One per core where 0 are asked for.
inline int threadsOf(int asked) {
  return asked > 0 ? asked : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

// Starts `num_threads` threads, hands them blocks of instances by a shared counter, joins them. `work(thread, instance)`.
template <typename Work>
void inThreads(int num_threads, int num_instances, int block, const Work& work) {
  std::atomic<int> next{0};
  const auto loop = [&](int thread) {
    // As Embree's manual asks; good for everybody.
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
