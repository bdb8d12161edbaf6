// Threads that share a loop.
#include "base/thread_team.h"
#include "support/test.h"

namespace taxelsim {
namespace {

TEST(ThreadTeam, RunsEveryIterationOnce) {
  for (const int num_threads : {1, 2, 3, 5}) {
    ThreadTeam team(num_threads);
    EXPECT_EQ(team.numThreads(), num_threads);
    for (const int count : {0, 1, 2, 4, 100}) {
      std::vector<int> runs(static_cast<std::size_t>(count), 0);
      team.run(count, [&](int first, int last) {
        for (int i = first; i < last; ++i) ++runs[static_cast<std::size_t>(i)];
      });
      EXPECT_TRUE(std::all_of(runs.begin(), runs.end(), [](int n) { return n == 1; })) << num_threads << " threads, " << count;
    }
  }
}

TEST(ThreadTeam, DividesALoopAmongItsThreadsWithTheCallerFirst) {
  constexpr int kThreads = 3, kCount = 10;
  ThreadTeam team(kThreads);
  std::vector<std::thread::id> threads(kCount);
  team.run(kCount, [&](int first, int last) { std::fill(threads.begin() + first, threads.begin() + last, std::this_thread::get_id()); });
  EXPECT_EQ(threads.front(), std::this_thread::get_id());
  EXPECT_EQ(std::set(threads.begin(), threads.end()).size(), static_cast<std::size_t>(kThreads));
  for (const std::thread::id& id : threads) {
    const auto size = std::count(threads.begin(), threads.end(), id);
    EXPECT_TRUE(size == 3 || size == 4) << size;
  }
}

// The results of a loop are visible to the next one, whichever thread computes them.
TEST(ThreadTeam, LoopsFollowEachOther) {
  constexpr int kCount = 1000, kLoops = 2000;
  ThreadTeam team(4);
  std::vector<int> a(kCount, 0), b(kCount, 0);
  for (int loop = 0; loop < kLoops; ++loop) {
    team.run(kCount, [&](int first, int last) {
      for (int i = first; i < last; ++i) b[static_cast<std::size_t>(i)] = a[static_cast<std::size_t>(kCount - 1 - i)] + 1;
    });
    std::swap(a, b);
  }
  EXPECT_EQ(a, std::vector<int>(kCount, kLoops));
}

}  // namespace
}  // namespace taxelsim
