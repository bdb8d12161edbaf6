// Shows the elapsed time of work of unknown duration.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace taxelsim::cli {

// While it exists, a thread of its own shows the name of the work and its seconds: in the status line of a terminal, or as a line every few
// seconds in a log. Short work shows nothing.
class Activity {
 public:
  explicit Activity(std::string what);
  ~Activity() { end(); }
  Activity(const Activity&) = delete;
  Activity& operator=(const Activity&) = delete;

  // Other work begins.
  void next(std::string what);
  // The same work has another name; its time goes on.
  void rename(std::string what);
  // Removes the line. May be called twice.
  void end();

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::string what_;
  bool ended_ = false;
  bool restarted_ = false;
  std::thread thread_;
};

}  // namespace taxelsim::cli
