// Files that appear whole or not at all, and the lock of a directory with one writer. Nothing about their content.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace taxelsim::dataset {

// Writes `bytes` to a hidden temporary file in the same directory, flushes it to disk, renames it to `file` and flushes the directory. The
// temporary file is removed when anything fails. Throws Error(kIo).
void writeFileAtomically(const std::filesystem::path& file, std::span<const std::byte> bytes);

// Whole file; throws Error(kIo) when it cannot be read.
std::string readTextFile(const std::filesystem::path& file);

// True for names that writeFileAtomically() uses while it works, left over when the process was killed.
bool isTemporaryName(const std::string& name);

// Removes a file, if it is there, and flushes the directory. Throws Error(kIo).
void removeFile(const std::filesystem::path& file);

inline constexpr const char* kLockName = ".lock";

// Holds the lock of a directory as long as it lives. The kernel frees the lock when the process ends, however it ends.
class DirectoryLock {
 public:
  // Throws Error(kIo) when somebody else holds it.
  explicit DirectoryLock(const std::filesystem::path& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace taxelsim::dataset
