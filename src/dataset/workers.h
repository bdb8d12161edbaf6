// Threads that share out jobs. Nothing about what the jobs do.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace taxelsim::dataset {

class Workers {
 public:
  // num_threads: >= 1. They run in the background (base/thread_priority.h). Throws std::system_error when there is no thread to be had.
  explicit Workers(int num_threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int numThreads() const { return static_cast<int>(threads_.size()); }

  // Calls job(worker, index) once for every index below num_jobs, lowest first, on thread `worker` (below numThreads()), and waits. After a
  // job has thrown none is begun any more, and what it threw is thrown here. From one thread at a time.
  void run(std::size_t num_jobs, const std::function<void(int worker, std::size_t index)>& job);

 private:
  void work(int worker);
  void stop();

  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void(int, std::size_t)>* job_ = nullptr;
  std::size_t num_jobs_ = 0;
  std::size_t next_ = 0;  // job to be begun
  std::size_t num_running_ = 0;
  std::exception_ptr error_;
  bool closing_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace taxelsim::dataset
