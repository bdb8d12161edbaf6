// Files that appear whole or not at all, and the lock of a directory with one writer. Nothing about their content.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace taxelsim::dataset {

// Writes `bytes` to a hidden temporary file in the same directory, flushes it to disk, renames it to `file` and flushes the directory. The
// temporary file is removed when anything fails. Throws Error(kIo).
void writeFileAtomically(const std::filesystem::path& file, std::span<const std::byte> bytes);

// A part of a file's content, wherever in memory it lies.
struct FilePiece {
  std::uint64_t offset = 0;
  std::span<const std::byte> bytes;
};

// A whole file, partly made for it, partly lying elsewhere: that must outlive this.
struct FileContent {
  struct Free {
    void operator()(void* data) const { std::free(data); }
  };

  std::uint64_t size = 0;         // bytes; those that no piece holds are zero
  std::vector<FilePiece> pieces;  // none reaches past the end
  std::unique_ptr<void, Free> made;
};

// The same, piece by piece.
void writeFileAtomically(const std::filesystem::path& file, const FileContent& content);

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
