// The library's log messages, and the lock of the Python interpreter.
//
// Any thread logs, with or without the GIL, and with locks that a thread with the GIL may wait for. So a message waits in a queue until a
// thread that has the GIL hands it to the logger "taxelsim": the calling one when it takes the GIL again, else the main thread.
#pragma once

#include "bind.h"

namespace taxelsim::python {

// Hands the queued messages to Python. Needs the GIL.
void deliverMessages() noexcept;

// Releases the GIL for its lifetime. The messages of the call are delivered at its end.
class WithoutGil {
 public:
  WithoutGil() : thread_(PyEval_SaveThread()) {}
  ~WithoutGil() {
    PyEval_RestoreThread(thread_);
    deliverMessages();
  }
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

 private:
  PyThreadState* thread_;
};

}  // namespace taxelsim::python
