// The side of the process that starts workers (workers/worker.h).
#pragma once

#include <sys/types.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "taxelsim/progress.h"
#include "workers/messages.h"
#include "workers/pipe.h"

namespace taxelsim::workers {

// What a worker sent.
struct WorkerReport {
  Progress progress;              // the last one; zeros if there is a problem
  std::vector<Message> messages;  // the others, without kEnd
  std::string problem;            // one line if it did not do its work: its error, or how it ended
};

// Thread-safe, except start() and join().
class WorkerProcesses {
 public:
  // `consequence`: what happens to the work of a worker that is lost, for the line in the log.
  explicit WorkerProcesses(std::string consequence) : consequence_(std::move(consequence)) {}
  // Asks the workers to stop and waits.
  ~WorkerProcesses();
  WorkerProcesses(const WorkerProcesses&) = delete;
  WorkerProcesses& operator=(const WorkerProcesses&) = delete;

  // Starts the workers 2 to `num_processes` with the arguments of this process and --worker K/N. They do not take SIGINT and SIGTERM; the
  // process that started them stops them. They are killed when the calling thread ends. A worker that cannot be started has a problem.
  void start(int num_processes);

  // Sum over the workers; without `seconds`.
  Progress progress() const;

  // Waits until all have ended. Asks them to stop when *stop is true. Calls `on_wait` a few times a second.
  void join(const std::atomic<bool>* stop, const std::function<void()>& on_wait);

  // (num_processes - 1), of worker 2 first. After join() only.
  const std::vector<WorkerReport>& reports() const { return reports_; }

 private:
  struct Child {
    pid_t process = -1;
    Descriptor control, messages;
    std::thread reader;
  };

  void startOne(std::size_t index);
  void read(std::size_t index);
  void lose(std::size_t index, const std::string& problem);
  void askToStop();  // with mutex_ locked

  const std::string consequence_;
  std::vector<Child> children_;
  mutable std::mutex mutex_;
  std::condition_variable ended_;
  std::size_t num_ended_ = 0;
  bool is_stopping_ = false;  // a worker that ends before it listens for the stop is no loss
  std::vector<WorkerReport> reports_;
};

}  // namespace taxelsim::workers
