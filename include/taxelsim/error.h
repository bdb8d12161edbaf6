/// @file
/// The exception of the library. Not for programmer errors: those throw std::logic_error or abort through assertions.
#pragma once

#include <stdexcept>
#include <string>

namespace taxelsim {

/// Who can act on an error.
enum class ErrorKind {
  kInput,   ///< A file, argument or value that the caller can correct; the command line exits with 2.
  kDevice,  ///< No device, out of device memory, or device lost; the command line exits with 1.
  kIo,      ///< The file system refused; the command line exits with 1.
};

/// An error with a message of one complete line.
///
/// For input the line names file, line, column, key, the value found and what is allowed; for the device, the buffer or call, its size and
/// a remedy.
class Error : public std::runtime_error {
 public:
  /// `message`: without a newline at its end. Newlines within become spaces.
  /// Control characters are escaped, so that text of a file cannot control a terminal; of more than 400 bytes the middle is left out.
  Error(ErrorKind kind, const std::string& message);

  /// An input error of one field of a settings struct, such as "readout.taxel_gain[3]". what() is "field: reason".
  Error(const std::string& field, const std::string& reason);

  /// Who can act on it.
  ErrorKind kind() const { return kind_; }

  /// Path of the field, from the struct that was checked; empty if the error is not of one field.
  const std::string& field() const { return field_; }

  /// The message without the field.
  const std::string& reason() const { return reason_; }

 private:
  ErrorKind kind_;
  std::string field_;
  std::string reason_;
};

}  // namespace taxelsim
