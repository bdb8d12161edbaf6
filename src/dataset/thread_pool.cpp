#include "dataset/thread_pool.h"

#include <utility>

#include "base/thread_priority.h"

namespace taxelsim::dataset {

ThreadPool::ThreadPool(int num_threads) {
  try {
    for (int thread = 0; thread < num_threads; ++thread) threads_.emplace_back([this, thread] { work(thread); });
  } catch (...) {
    stop();
    throw;
  }
}

ThreadPool::~ThreadPool() {
  stop();
}

void ThreadPool::stop() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ThreadPool::work(int thread) {
  lowerThreadPriority();
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return closing_ || next_ < num_jobs_; });
    if (closing_) return;
    const std::size_t index = next_++;
    const auto& job = *job_;
    ++num_running_;
    lock.unlock();
    std::exception_ptr error;
    try {
      job(thread, index);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    if (error) {
      if (!error_) error_ = error;
      next_ = num_jobs_;
    }
    if (--num_running_ == 0 && next_ == num_jobs_) changed_.notify_all();
  }
}

void ThreadPool::run(std::size_t num_jobs, const std::function<void(int thread, std::size_t index)>& job) {
  std::unique_lock lock(mutex_);
  job_ = &job;
  num_jobs_ = num_jobs;
  next_ = 0;
  changed_.notify_all();
  changed_.wait(lock, [this] { return num_running_ == 0 && next_ == num_jobs_; });
  num_jobs_ = next_ = 0;
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

}  // namespace taxelsim::dataset
