// What goes wrong, as one exception type. Not for programmer errors: those abort through assertions.
#pragma once

#include <stdexcept>
#include <string>

namespace taxelsim {

enum class ErrorKind {
  kInput,   // a file, argument or value the caller can mend; the CLI exits with 2
  kDevice,  // no device, out of device memory, device lost; the CLI exits with 1
  kIo,      // the file system refused; the CLI exits with 1
};

// The message is one line that is complete on its own: for input, file, line, column, key, the value found and what is
// allowed; for the device, the buffer or call, its size and what to do.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace taxelsim
