// A fixed number of threads that run the iterations of a loop.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace taxelsim::dataset {

class ThreadPool {
 public:
  // `num_threads` >= 1, with lowered priority (base/thread_priority.h). Throws std::system_error if a thread cannot be created.
  explicit ThreadPool(int num_threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int numThreads() const { return static_cast<int>(threads_.size()); }

  // Calls job(thread, index) once for every index < num_jobs, in ascending order of start, on thread `thread` < numThreads(). Waits
  // for all. After a job has thrown no further job is started, and the first exception is rethrown here. Must be called from one
  // thread at a time.
  void run(std::size_t num_jobs, const std::function<void(int thread, std::size_t index)>& job);

 private:
  void work(int thread);
  void stop();

  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void(int, std::size_t)>* job_ = nullptr;
  std::size_t num_jobs_ = 0;
  std::size_t next_ = 0;  // index of the next job to start
  std::size_t num_running_ = 0;
  std::exception_ptr error_;
  bool closing_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace taxelsim::dataset
