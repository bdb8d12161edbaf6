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
#include <filesystem>

#include "base/files.h"

namespace taxelsim::dataset {

// "shard-000012.h5.sha256"
std::filesystem::path checksumFile(const std::filesystem::path& file);

// Creates or replaces the checksum, then the file. Throws Error(kIo).
void writeWithChecksum(const std::filesystem::path& file, const FileContent& content);

// Removes the file, then its checksum, if they exist. Throws Error(kIo).
void removeWithChecksum(const std::filesystem::path& file);

// Throws Error(kInput) unless the file is a regular file with the SHA-256 of its checksum file, and Stopped as sha256File() does.
void verifyChecksum(const std::filesystem::path& file, const std::atomic<bool>* stop = nullptr);

}  // namespace taxelsim::dataset
