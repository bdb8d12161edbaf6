// Ownership of device handles across fork().
#pragma once

#include <unistd.h>

#include <memory>
#include <string>
#include <utility>

#include "taxelsim/error.h"

namespace taxelsim::python {

// A Device, Model or Simulator of the process that made it. In a child process, where the threads of the driver do not exist, use throws
// Error(kDevice) and destruction does nothing.
template <typename Handle>
class Owned {
 public:
  template <typename... Arguments>
  explicit Owned(Arguments&&... arguments)
      : handle_(std::make_unique<Handle>(std::forward<Arguments>(arguments)...)), process_(::getpid()) {}
  Owned(Owned&&) noexcept = default;
  Owned& operator=(Owned&&) = delete;
  ~Owned() {
    if (::getpid() != process_) static_cast<void>(handle_.release());
  }

  Handle& get() const {
    if (::getpid() != process_) {
      throw Error(ErrorKind::kDevice,
                  "this device belongs to the parent process: a device does not survive fork(); open it in the child process, or start "
                  "processes with multiprocessing.get_context(\"spawn\")");
    }
    return *handle_;
  }

 private:
  std::unique_ptr<Handle> handle_;
  pid_t process_;
};

}  // namespace taxelsim::python
