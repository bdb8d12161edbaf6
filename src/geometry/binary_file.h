// Reading binary files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace taxelsim {

// `bytes`, at most eight, as a little-endian number.
std::uint64_t readLittleEndian(std::string_view bytes);

// The first four bytes of `bytes`, which has at least four, as a little-endian number.
std::uint32_t readLittleEndian32(std::string_view bytes);

// Reads the file in blocks of 64 KiB until at least `min_bytes` are read or the file ends. The result may be up to a block
// longer than `min_bytes`.
std::string readStart(const std::filesystem::path& file, std::size_t min_bytes);

}  // namespace taxelsim
