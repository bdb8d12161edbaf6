// Bytes of a file, as they lie on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace taxelsim {

// The first four bytes as a number, least significant first; there must be four.
std::uint32_t littleEndian32(std::string_view bytes);

// The file from its start, whole blocks until at least `limit` bytes are read or it ends.
std::string readBytes(const std::filesystem::path& file, std::size_t limit);

}  // namespace taxelsim
