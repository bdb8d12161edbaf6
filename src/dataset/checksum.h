// Checksum files: NAME.sha256 next to each HDF5 file, with the SHA-256 of its bytes as `sha256sum` writes it.
//
// The checksum is written first, and the file is renamed last (files.h). A file that exists is therefore complete and has its checksum:
//
//   killed before the checksum is renamed:  neither exists
//   killed before the file is renamed:      the checksum exists without its file, which is missing; the next writer replaces the checksum
//
// A file without a checksum, or one that differs from it, was changed after it was written.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <string>

#include "base/files.h"

namespace taxelsim::dataset {

inline constexpr std::size_t kDigestDigits = 64;

// Whether a text is a SHA-256 as lower-case hexadecimal digits.
bool isDigest(const std::string& text);

// "shard-000012.h5.sha256"
std::filesystem::path checksumFile(const std::filesystem::path& file);

// Creates or replaces the checksum, then the file. Returns the digest. Throws Error(kIo).
std::string writeWithChecksum(const std::filesystem::path& file, const FileContent& content);

// Removes the file, then its checksum, if they exist. Throws Error(kIo).
void removeWithChecksum(const std::filesystem::path& file);

// The digest in the checksum file of `file`. Throws Error(kInput) if there is none, or not a line of sha256sum for the file.
std::string readChecksum(const std::filesystem::path& file);

// Compares a file with its checksum file. Returns the digest. Throws Error(kInput) unless the file is a regular file with that digest, and
// Stopped as sha256File() does.
std::string compareChecksum(const std::filesystem::path& file, const std::atomic<bool>* stop = nullptr);

// The same, unless this process has done so since the file last changed. Thread-safe.
std::string verifyChecksum(const std::filesystem::path& file, const std::atomic<bool>* stop = nullptr);

}  // namespace taxelsim::dataset
