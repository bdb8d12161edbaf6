// Threads that share a loop over instances whose iterations are independent of each other.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace taxelsim {

class ThreadTeam {
 public:
  // Starts num_threads - 1 threads (num_threads >= 1), which sleep between loops. Throws std::system_error if one cannot be created.
  explicit ThreadTeam(int num_threads);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  int numThreads() const { return static_cast<int>(threads_.size()) + 1; }

  // Calls job(first, last) for numThreads() contiguous parts of [0, count), whose sizes differ by at most 1: the first part on the calling
  // thread, each other part on another thread. Waits for all. The job must not throw. Must be called from one thread at a time. Does not
  // allocate.
  template <typename Job>
  void run(int count, const Job& job) {
    if (threads_.empty()) return job(0, count);
    call_ = [](const void* called, int first, int last) { (*static_cast<const Job*>(called))(first, last); };
    job_ = &job;
    count_ = count;
    share();
  }

 private:
  void share();
  void runPart(int part) const;
  void work(int part);
  void stop();

  void (*call_)(const void*, int, int) = nullptr;
  const void* job_ = nullptr;
  int count_ = 0;
  bool closing_ = false;
  std::atomic<std::uint32_t> loop_ = 0;  // number of the latest loop; the threads wait for the next
  std::atomic<int> num_running_ = 0;     // threads that have not finished it
  std::vector<std::thread> threads_;
};

}  // namespace taxelsim
