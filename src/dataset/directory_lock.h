// Exclusion of other writers from the directory of a data set.
#pragma once

#include <filesystem>

namespace taxelsim::dataset {

inline constexpr const char* kLockName = ".lock";

// Exclusive advisory lock of a directory: flock() on a file in it, for the lifetime of the object. The kernel releases it when the process
// ends for any reason.
class DirectoryLock {
 public:
  // Does not wait. Throws Error(kIo) if another process or object holds the lock.
  explicit DirectoryLock(const std::filesystem::path& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace taxelsim::dataset
