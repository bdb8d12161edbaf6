#include "dataset/thread_pool.h"

#include <atomic>

#include "support/test.h"

namespace taxelsim::dataset {
namespace {

TEST(ThreadPool, RunsEveryJobOnce) {
  for (const int num_threads : {1, 2, 7}) {
    ThreadPool threads(num_threads);
    EXPECT_EQ(threads.numThreads(), num_threads);
    for (const std::size_t num_jobs : {0u, 1u, 2u, 1000u}) {
      std::vector<std::atomic<int>> times(num_jobs);
      std::atomic<bool> out_of_range = false;
      threads.run(num_jobs, [&](int thread, std::size_t index) {
        ++times[index];
        if (thread < 0 || thread >= num_threads) out_of_range = true;
      });
      for (std::size_t i = 0; i < num_jobs; ++i) EXPECT_EQ(times[i], 1) << "job " << i << " of " << num_jobs;
      EXPECT_FALSE(out_of_range);
    }
  }
}

TEST(ThreadPool, RethrowsTheFirstException) {
  for (const int num_threads : {1, 3}) {
    ThreadPool threads(num_threads);
    std::atomic<int> num_done = 0;
    try {
      threads.run(1000, [&](int, std::size_t index) {
        if (index == 5) throw std::runtime_error("five");
        ++num_done;
      });
      ADD_FAILURE() << "nothing thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(), std::string("five"));
    }
    EXPECT_GE(num_done, 5);
    // Other threads may finish all jobs before the exception is stored. One thread may not start another.
    if (num_threads == 1) {
      EXPECT_EQ(num_done, 5) << "jobs were started after an exception";
    }
    num_done = 0;
    threads.run(20, [&](int, std::size_t) { ++num_done; });
    EXPECT_EQ(num_done, 20) << "the pool is usable after an exception";
  }
}

}  // namespace
}  // namespace taxelsim::dataset
