// Exclusion of other writers from the directory of a data set.
#pragma once

#include <filesystem>

namespace taxelsim::dataset {

inline constexpr const char* kLockName = ".lock";

enum class LockMode {
  kExclusive,  // excludes all others
  kShared,     // excludes those with an exclusive lock
};

// Advisory lock of a directory: flock() on a file in it, for the lifetime of the object. The kernel releases it when the process ends for
// any reason.
class DirectoryLock {
 public:
  // Does not wait. Throws Error(kIo) if another process or object holds a lock that excludes this one.
  explicit DirectoryLock(const std::filesystem::path& directory, LockMode mode = LockMode::kExclusive);
  // Removes the file of an exclusive lock. That of a shared lock stays, since others may hold it.
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  void lock();

  std::filesystem::path file_;
  LockMode mode_;
  int descriptor_ = -1;
};

}  // namespace taxelsim::dataset
