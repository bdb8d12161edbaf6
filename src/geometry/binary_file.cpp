#include "geometry/binary_file.h"

#include <fstream>
#include <vector>

namespace taxelsim {

std::uint64_t readLittleEndian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  return value;
}

std::uint32_t readLittleEndian32(std::string_view bytes) {
  return static_cast<std::uint32_t>(readLittleEndian(bytes.substr(0, 4)));
}

std::string readStart(const std::filesystem::path& file, std::size_t min_bytes) {
  std::ifstream stream(file, std::ios::binary);
  std::string bytes;
  std::vector<char> block(std::size_t{1} << 16);
  while (bytes.size() < min_bytes && stream.read(block.data(), static_cast<std::streamsize>(block.size())).gcount() > 0) {
    bytes.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  return bytes;
}

}  // namespace taxelsim
