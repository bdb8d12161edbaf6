#include "base/awake_cores.h"

#include <gtest/gtest.h>

#include <sched.h>

#include <chrono>
#include <thread>

namespace taxelsim {
namespace {

// Threads that give way to everybody may wait long on a busy machine.
constexpr std::chrono::seconds kPatience(60);
// Less than the gap over which they stay awake.
constexpr std::chrono::microseconds kPause(50);

// Whether that many come to be awake.
bool comesTo(AwakeCores& cores, int num_awake, bool calls) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (cores.numAwake() != num_awake) {
    if (std::chrono::steady_clock::now() > end) return false;
    if (calls) cores.stayAwake();
    std::this_thread::sleep_for(kPause);
  }
  return true;
}

TEST(AwakeCores, AreAwakeForAWhile) {
  AwakeCores cores;
  cores.stayAwake();  // before there are threads
  cores.start();
  // Where a quota limits the process there are none.
  EXPECT_TRUE(comesTo(cores, cores.numThreads(), true));
  EXPECT_TRUE(comesTo(cores, 0, false));
  EXPECT_TRUE(comesTo(cores, cores.numThreads(), true));
}  // ends while they are awake

TEST(AwakeCores, RestBeforeTheyStart) {
  AwakeCores cores;
  cores.stayAwake();
  EXPECT_EQ(cores.numAwake(), 0);
}

TEST(AwakeCores, LeaveTheCallerAsItWas) {
  cpu_set_t before, after;
  ASSERT_EQ(sched_getaffinity(0, sizeof(before), &before), 0);
  AwakeCores cores;
  cores.start();
  cores.stayAwake();
  EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER);
  ASSERT_EQ(sched_getaffinity(0, sizeof(after), &after), 0);
  EXPECT_TRUE(CPU_EQUAL(&before, &after));
}

}  // namespace
}  // namespace taxelsim
