// SHA-256 of bytes and files, for naming content. Not for secrets.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace taxelsim {

// 64 lower-case hexadecimal digits.
std::string sha256Hex(std::span<const std::byte> bytes);

// The same of a regular file's bytes, read in pieces. Throws Error(kInput) when there is no such file, Error(kIo) when it cannot be read.
std::string sha256File(const std::filesystem::path& file);

}  // namespace taxelsim
