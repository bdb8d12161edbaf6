// The side of a worker: a child process of the program that does a share of its work.
//
// Its standard input is a pipe whose end stops it; its standard output takes its messages. It ends with the process that started it:
// the kernel kills it (PR_SET_PDEATHSIG) when that process ends for any reason.
#pragma once

#include <atomic>
#include <functional>
#include <span>

#include "workers/messages.h"

namespace taxelsim {
struct Progress;
}

namespace taxelsim::workers {

class Worker {
 public:
  const std::atomic<bool>* stop() const;

  void report(const Progress& progress) const;

  template <class T>
  void sendValues(MessageKind kind, std::span<const T> values) const {
    static_assert(std::is_trivially_copyable_v<T>);
    sendBytes(kind, std::as_bytes(values));
  }

 private:
  friend int runWorker(const std::function<void(const Worker&)>& work);
  Worker() = default;
  void sendBytes(MessageKind kind, std::span<const std::byte> bytes) const;
};

// Runs `work`, and sends what it throws as a message. Returns the exit status of the process. Once in a process.
int runWorker(const std::function<void(const Worker&)>& work);

}  // namespace taxelsim::workers
