// Identity of a file's content as far as the file system knows it: changes whenever the file is written, truncated or replaced.
#pragma once

#include <cstdint>
#include <filesystem>

namespace taxelsim::dataset {

struct FileStamp {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::uint64_t size = 0;    // bytes
  std::int64_t changed = 0;  // ns since 1970, the later one of the times of modification and of status change

  bool operator==(const FileStamp&) const = default;
};

// Throws Error(kIo).
FileStamp stampOf(const std::filesystem::path& file);

}  // namespace taxelsim::dataset
