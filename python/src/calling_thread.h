// Lets a worker thread run code in the thread that waits for it: the one that holds the GIL and receives Ctrl-C.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <stdexcept>

namespace taxelsim::python {

class CallingThread {
 public:
  // In the worker: runs `work` in the calling thread and waits for it. Throws std::runtime_error after abandon().
  void run(const std::function<void()>& work) {
    std::unique_lock lock(mutex_);
    if (!abandoned_) {
      work_ = &work;
      changed_.notify_all();
      changed_.wait(lock, [&] { return !work_ || abandoned_; });
    }
    work_ = nullptr;
    if (abandoned_) throw std::runtime_error("the calling thread has stopped");
  }

  // In the worker, at its end.
  void finish() {
    const std::lock_guard lock(mutex_);
    finished_ = true;
    changed_.notify_all();
  }

  // In the calling thread: waits at most `time` for work or for the end of the worker. Returns the work, or null.
  template <typename Duration>
  const std::function<void()>* wait(Duration time) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, time, [&] { return work_ || finished_; });
    return work_;
  }

  // In the calling thread, after the work.
  void answer() {
    const std::lock_guard lock(mutex_);
    work_ = nullptr;
    changed_.notify_all();
  }

  // In the calling thread: runs no more work.
  void abandon() {
    const std::lock_guard lock(mutex_);
    abandoned_ = true;
    changed_.notify_all();
  }

  bool finished() {
    const std::lock_guard lock(mutex_);
    return finished_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void()>* work_ = nullptr;
  bool finished_ = false;
  bool abandoned_ = false;
};

}  // namespace taxelsim::python
