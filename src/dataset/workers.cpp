#include "dataset/workers.h"

#include <utility>

#include "base/thread_priority.h"

namespace taxelsim::dataset {

Workers::Workers(int num_threads) {
  try {
    for (int worker = 0; worker < num_threads; ++worker) threads_.emplace_back([this, worker] { work(worker); });
  } catch (...) {
    stop();
    throw;
  }
}

Workers::~Workers() {
  stop();
}

void Workers::stop() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Workers::work(int worker) {
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
      job(worker, index);
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

void Workers::run(std::size_t num_jobs, const std::function<void(int worker, std::size_t index)>& job) {
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
