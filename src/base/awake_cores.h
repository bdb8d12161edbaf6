// Cores that do not fall asleep while short work goes from thread to thread.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

namespace taxelsim {

// A driver on the processor hands every kernel to threads that sleep between two of them, and a core that has nothing else to do halts. To
// wake it again takes a virtual machine 40 to 50 us, and a kernel over a small batch lasts little longer. For a while after each call of
// stayAwake(), these threads keep a core each from halting in such gaps, under Linux's policy SCHED_IDLE: they run where nobody else would,
// and give way at once.
//
// Safe to use from several threads. Where the policy is refused, or the process may only use so much time of the processor (a quota of its
// control group), which this would use up, nothing is kept awake.
class AwakeCores {
 public:
  AwakeCores() = default;
  ~AwakeCores();  // waits for its threads, which end at once
  AwakeCores(const AwakeCores&) = delete;
  AwakeCores& operator=(const AwakeCores&) = delete;

  // Starts the threads, one for each core that the process may use; before, nothing is kept awake.
  void start();

  // From now on for kAwake, and in a gap for half a millisecond at most. Takes less than a microsecond where cores are awake, and does not
  // wait.
  void stayAwake();
  static constexpr std::chrono::milliseconds kAwake{50};  // longer than a step of some thousand instances

  int numThreads() const { return num_threads_; }
  int numAwake() const { return num_awake_; }  // of these threads

 private:
  void keepAwake(int core);

  static constexpr int kEnd = -1;
  std::atomic<int> calls_ = 0;  // of stayAwake(), or kEnd
  std::atomic<int> num_threads_ = 0;
  std::atomic<int> num_awake_ = 0;
  std::once_flag started_;
  std::vector<std::thread> threads_;
};

}  // namespace taxelsim
