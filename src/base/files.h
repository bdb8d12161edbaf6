// Crash-safe file writing.
//
// Protocol:
//
//   open(".NAME.tmp-RANDOM", O_EXCL | O_NOFOLLOW)  write  fsync  close  rename(NAME)  fsync(directory)
//                                                  |
//   killed before rename: NAME is unchanged; the temporary file is removed by the next writer (isTemporaryName())
//   killed after rename:  NAME has the complete new content
//
// rename() is atomic on POSIX file systems. fsync before it ensures that the new name never refers to data that is not on disk; fsync
// of the directory makes the new name durable. A reader therefore finds each file with its complete old or complete new content, or
// not at all. The random number keeps writers on several machines apart, whose process numbers may be equal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace taxelsim {

// Creates or replaces `file` with the protocol above. Removes the temporary file on failure. Throws Error(kIo).
void writeFileAtomically(const std::filesystem::path& file, std::span<const std::byte> bytes);

// A range of a file, in memory that is owned elsewhere.
struct FilePiece {
  std::uint64_t offset = 0;
  std::span<const std::byte> bytes;
};

// The content of a file as pieces that point into `buffer` or into memory of the caller, which must outlive it. Avoids copying rows.
struct FileContent {
  struct Free {
    void operator()(void* data) const { std::free(data); }
  };

  std::uint64_t size = 0;              // bytes; ranges without a piece are zero
  std::vector<FilePiece> pieces;       // disjoint and in order, within size
  std::unique_ptr<void, Free> buffer;  // allocated with malloc()
};

// As above, from pieces.
void writeFileAtomically(const std::filesystem::path& file, const FileContent& content);

// Creates a directory and its parents where they are missing, and flushes the parent of each one that it creates, so that a power cut does
// not lose the directory with the files in it. Throws Error(kIo).
void createDirectories(const std::filesystem::path& directory);

// Why `file` cannot be an input file: it is missing, larger than `max_bytes`, or not a regular file. A FIFO would block the program, and a
// device may have no end. Empty if it can be.
std::string inputFileProblem(const std::filesystem::path& file, std::uintmax_t max_bytes);

// Reads a whole input file. Throws Error(kInput) if it cannot be one, Error(kIo) if it cannot be read.
std::string readTextFile(const std::filesystem::path& file, std::uintmax_t max_bytes);

// True for names of temporary files of writeFileAtomically(). They remain where a process was killed.
bool isTemporaryName(const std::string& name);

// The directory of this user for what can be computed again: $XDG_CACHE_HOME/taxelsim, else $HOME/.cache/taxelsim. Empty without both.
std::filesystem::path userCacheDirectory();

// Removes a file, if it exists, and flushes the directory. Throws Error(kIo).
void removeFile(const std::filesystem::path& file);

}  // namespace taxelsim
