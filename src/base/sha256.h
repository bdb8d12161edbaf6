// SHA-256 digests that identify content and detect damage.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace taxelsim {

// The digest as 64 lower-case hexadecimal digits.
std::string sha256Hex(std::span<const std::byte> bytes);

// The digest of a regular file, read in blocks of 1 MiB. Throws Error(kInput) when there is no regular file of that name, Error(kIo) when
// it cannot be read.
std::string sha256File(const std::filesystem::path& file);

}  // namespace taxelsim
