// Sets TAXELSIM_PLAIN during the lifetime of an object.
#pragma once

#include "support/test.h"

namespace taxelsim::support {

// Restores the variable.
class Plain {
 public:
  explicit Plain(const std::string& names) {
    if (const char* value = std::getenv(kName)) before_ = value;
    ::setenv(kName, names.c_str(), 1);
  }
  ~Plain() { ::setenv(kName, before_.c_str(), 1); }
  Plain(const Plain&) = delete;
  Plain& operator=(const Plain&) = delete;

 private:
  static constexpr const char* kName = "TAXELSIM_PLAIN";
  std::string before_;
};

// Whether the environment switches a fast path off for the whole run.
inline bool isSwitchedOff(const std::string& path) {
  const char* value = std::getenv("TAXELSIM_PLAIN");
  const std::string names = value == nullptr ? "" : value;
  return names == "all" || names.find(path) != std::string::npos;
}

}  // namespace taxelsim::support
