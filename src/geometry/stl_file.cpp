#include "geometry/stl_file.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <fstream>
#include <string_view>
#include <vector>

#include "base/byte_order_mark.h"
#include "base/text.h"
#include "geometry/binary_file.h"

namespace taxelsim {
namespace {

constexpr std::size_t kHeader = 84;    // bytes: 80 of text, then the number of triangles in 4
constexpr std::size_t kTriangle = 50;  // bytes: normal, three vertices, attributes in 2
constexpr std::size_t kNormal = 12;    // bytes
constexpr std::size_t kBlock = 4096;   // triangles read at once

std::string readBinary(const std::filesystem::path& file, std::size_t count, Mesh& mesh) {
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(kHeader);
  std::vector<char> block(kBlock * kTriangle);
  mesh.vertices.reserve(3 * count);
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t in_block = std::min(kBlock, count - first);
    if (!stream.read(block.data(), static_cast<std::streamsize>(in_block * kTriangle))) return "it cannot be read";
    for (std::size_t i = 0; i < in_block; ++i) {
      std::string_view at(block.data() + i * kTriangle + kNormal, kTriangle - kNormal);
      for (int corner = 0; corner < 3; ++corner) {
        std::array<float, 3> vertex;
        for (float& coordinate : vertex) {
          coordinate = std::bit_cast<float>(readLittleEndian32(at));
          at.remove_prefix(sizeof(float));
        }
        mesh.vertices.push_back(vertex);
      }
    }
  }
  return {};
}

// The words of a facet are `facet normal x y z outer loop vertex x y z vertex x y z vertex x y z endloop endfacet`.
std::string readText(std::string_view text, Mesh& mesh) {
  if (text.find("endsolid") == std::string_view::npos) return "it ends before endsolid";
  constexpr const char* kBlanks = " \t\r\n\v\f";
  std::size_t at = 0;
  const auto next = [&] {
    const std::size_t begin = std::min(text.find_first_not_of(kBlanks, at), text.size());
    at = std::min(text.find_first_of(kBlanks, begin), text.size());
    return text.substr(begin, at - begin);
  };
  std::size_t num_corners = 0;  // of the facet
  for (std::string_view word = next(); !word.empty(); word = next()) {
    if (word == "solid" || word == "endsolid") at = std::min(text.find('\n', at), text.size());  // a name
    if (word == "facet") num_corners = 0;
    if (word == "endfacet" && num_corners != 0 && num_corners != 3)
      return "facet " + std::to_string(mesh.vertices.size() / 3) + " has " + std::to_string(num_corners) + " vertices, not 3";
    if (word != "vertex") continue;
    if (++num_corners > 3) return "facet " + std::to_string(mesh.vertices.size() / 3 - 1) + " has more than 3 vertices";
    std::array<float, 3> vertex;
    for (float& coordinate : vertex) {
      const std::string_view digits = next();
      double value = 0;
      if (digits.empty() || !parseNumber(digits.substr(digits[0] == '+' ? 1 : 0), value))
        return "vertex " + std::to_string(mesh.vertices.size()) + " has the coordinate " + oneLine(digits).substr(0, kMaxShown) +
               ", which is not a finite number";
      coordinate = static_cast<float>(value);
    }
    mesh.vertices.push_back(vertex);
  }
  if (mesh.vertices.size() % 3 != 0) return "its last facet has not 3 vertices";
  return {};
}

}  // namespace

std::string readStl(const std::filesystem::path& file, Mesh& mesh) {
  const std::string head = readStart(file, kHeader).substr(0, kHeader);
  const std::uintmax_t size = std::filesystem::file_size(file);
  const std::string_view start = withoutByteOrderMark(head);
  const bool is_text = start.substr(std::min(start.find_first_not_of(" \t\r\n"), start.size())).starts_with("solid");
  std::string problem;
  std::uintmax_t count = 0, expected = 0;
  if (head.size() >= kHeader) {
    count = readLittleEndian32(std::string_view(head).substr(80));
    expected = kHeader + count * kTriangle;
  }
  if (head.size() >= kHeader && size == expected) {
    problem = readBinary(file, count, mesh);
  } else {
    const bool is_binary_in_32_bits = static_cast<std::uint32_t>(size) == static_cast<std::uint32_t>(expected);
    if (head.size() >= kHeader && (is_binary_in_32_bits || !is_text)) {
      return "its header claims " + std::to_string(count) + " triangles, which take " + std::to_string(expected) + " bytes, but it has " +
             std::to_string(size);
    }
    if (!is_text) return "it is neither binary STL nor text that starts with solid";
    problem = readText(withoutByteOrderMark(readStart(file, static_cast<std::size_t>(kMaxMeshFileBytes))), mesh);
  }
  for (std::uint32_t i = 0; i + 2 < mesh.vertices.size(); i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
  return problem;
}

}  // namespace taxelsim
