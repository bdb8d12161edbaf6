#include "geometry/mesh_file_validation.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <string_view>
#include <vector>

#include "base/text.h"
#include "geometry/binary_file.h"
#include "geometry/gltf_validation.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

constexpr std::size_t kStlHeader = 84;    // bytes: 80 of text, then the number of triangles in 4
constexpr std::size_t kStlTriangle = 50;  // bytes

// Parses the coordinates of vertex lines strictly: Assimp reads "1,5" and "1.5.5" as 1.5.
std::string validateObj(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string line;
  std::size_t num_vertices = 0;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    std::istringstream words(line);
    std::string word;
    if (!(words >> word) || word != "v" || line.find('\\') != std::string::npos) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(words >> word)) return "line " + std::to_string(number) + ": vertex " + std::to_string(num_vertices) + " lacks a coordinate";
      double coordinate = 0;
      const std::string_view digits = std::string_view(word).substr(word[0] == '+' ? 1 : 0);
      if (!parseNumber(digits, coordinate) || std::abs(coordinate) > std::numeric_limits<float>::max()) {
        return "line " + std::to_string(number) + ": vertex " + std::to_string(num_vertices) + " has the coordinate " +
               oneLine(word).substr(0, 40) + ", which is not a finite number";
      }
    }
    ++num_vertices;
  }
  return {};
}

// A binary file must have exactly the size that its number of triangles implies. Any other file must be text that starts with "solid" and
// ends with "endsolid".
std::string validateStl(const std::filesystem::path& file) {
  const std::string head = readStart(file, kStlHeader).substr(0, kStlHeader);
  const std::uintmax_t size = std::filesystem::file_size(file);
  const std::size_t start = head.find_first_not_of(" \t\r\n");
  const bool is_text = start != std::string::npos && head.compare(start, 5, "solid") == 0;
  if (head.size() >= kStlHeader) {
    const std::uintmax_t count = readLittleEndian32(std::string_view(head).substr(80));
    const std::uintmax_t expected = kStlHeader + count * kStlTriangle;
    if (size == expected) return {};
    const bool is_binary_in_32_bits = static_cast<std::uint32_t>(size) == static_cast<std::uint32_t>(expected);
    if (is_binary_in_32_bits || !is_text) {
      return "its header claims " + std::to_string(count) + " triangles, which take " + std::to_string(expected) + " bytes, but it has " +
             std::to_string(size);
    }
  }
  if (!is_text) return "it starts neither with solid nor with a binary STL header";

  constexpr std::uintmax_t kTail = 4096;  // bytes; longer than any plausible name after endsolid
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(size > kTail ? size - kTail : 0));
  const std::string tail{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (tail.find("endsolid") == std::string::npos) return "it ends before endsolid";
  return {};
}

struct PlyProperty {
  std::size_t bytes = 0;       // of one value
  std::size_t list_bytes = 0;  // of the length of a list; 0 for a scalar
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

std::size_t plyTypeBytes(std::string_view type) {
  for (const char* one : {"char", "uchar", "int8", "uint8"}) {
    if (type == one) return 1;
  }
  for (const char* two : {"short", "ushort", "int16", "uint16"}) {
    if (type == two) return 2;
  }
  for (const char* four : {"int", "uint", "int32", "uint32", "float", "float32"}) {
    if (type == four) return 4;
  }
  for (const char* eight : {"double", "float64"}) {
    if (type == eight) return 8;
  }
  return 0;
}

enum class PlyEncoding { kAscii, kLittle, kBig };

// Skips through all elements of a binary body. Returns false if the body ends before the last one.
bool isPlyBinaryComplete(std::string_view body, const std::vector<PlyElement>& elements, PlyEncoding encoding) {
  std::size_t at = 0;
  for (const PlyElement& element : elements) {
    for (std::uint64_t row = 0; row < element.count; ++row) {
      for (const PlyProperty& property : element.properties) {
        std::uint64_t values = 1;
        if (property.list_bytes > 0) {
          if (body.size() - at < property.list_bytes) return false;
          values = 0;
          for (std::size_t i = 0; i < property.list_bytes; ++i) {
            const std::size_t byte = encoding == PlyEncoding::kLittle ? property.list_bytes - 1 - i : i;
            values = values << 8 | static_cast<unsigned char>(body[at + byte]);
          }
          at += property.list_bytes;
        }
        if (values > (body.size() - at) / property.bytes) return false;
        at += values * property.bytes;
      }
    }
  }
  return true;
}

// Skips through all elements of a text body. Returns false if the body ends before the last one.
bool isPlyAsciiComplete(std::string_view body, const std::vector<PlyElement>& elements) {
  std::size_t at = 0;
  const auto nextWord = [&] {
    constexpr const char* kBlanks = " \t\r\n\v\f";
    const std::size_t begin = std::min(body.find_first_not_of(kBlanks, at), body.size());
    at = std::min(body.find_first_of(kBlanks, begin), body.size());
    return body.substr(begin, at - begin);
  };
  for (const PlyElement& element : elements) {
    for (std::uint64_t row = 0; row < element.count; ++row) {
      for (const PlyProperty& property : element.properties) {
        std::uint64_t values = 1;
        if (property.list_bytes > 0) {
          const std::string_view word = nextWord();
          if (std::from_chars(word.data(), word.data() + word.size(), values).ec != std::errc()) return false;
        }
        if (values > body.size() - at) return false;
        for (std::uint64_t i = 0; i < values; ++i) {
          if (nextWord().empty()) return false;
        }
      }
    }
  }
  return true;
}

std::string validatePly(const std::filesystem::path& file) {
  const std::string bytes = readStart(file, static_cast<std::size_t>(kMaxMeshFileBytes));
  std::vector<PlyElement> elements;
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::size_t at = 0;
  for (bool in_header = true; in_header;) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string::npos) return "its PLY header has no end";
    const std::string line = bytes.substr(at, end - at);
    at = end + 1;
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "format") {
      words >> word;
      if (word == "binary_little_endian") encoding = PlyEncoding::kLittle;
      if (word == "binary_big_endian") encoding = PlyEncoding::kBig;
    } else if (word == "element") {
      PlyElement element;
      std::string count;
      words >> element.name >> count;
      const std::from_chars_result result = std::from_chars(count.data(), count.data() + count.size(), element.count);
      if (result.ec != std::errc() || result.ptr != count.data() + count.size()) return "its PLY header has a bad line: " + oneLine(line);
      if (element.count > bytes.size()) {
        return "its header claims " + count + " x " + oneLine(element.name) + ", more than the file has bytes (" +
               std::to_string(bytes.size()) + ")";
      }
      elements.push_back(element);
    } else if (word == "property") {
      PlyProperty property;
      words >> word;
      if (word == "list") {
        words >> word;
        property.list_bytes = plyTypeBytes(word);
        words >> word;
        if (property.list_bytes == 0 || property.list_bytes == 8) return "its PLY header has a bad line: " + oneLine(line);
      }
      property.bytes = plyTypeBytes(word);
      if (elements.empty() || property.bytes == 0) return "its PLY header has a bad line: " + oneLine(line);
      elements.back().properties.push_back(property);
    } else if (word == "end_header") {
      in_header = false;
    }
  }
  for (const PlyElement& element : elements) {
    if (element.properties.empty() && element.count > 0) return "its PLY header has no property for element " + oneLine(element.name);
  }
  const std::string_view body = std::string_view(bytes).substr(at);
  const bool is_complete =
      encoding == PlyEncoding::kAscii ? isPlyAsciiComplete(body, elements) : isPlyBinaryComplete(body, elements, encoding);
  return is_complete ? std::string() : "it ends before the last element that its header or a list claims";
}

}  // namespace

std::string validateMeshFile(const std::filesystem::path& file, MeshFormat format) {
  switch (format) {
    case MeshFormat::kObj:
      return validateObj(file);
    case MeshFormat::kStl:
      return validateStl(file);
    case MeshFormat::kPly:
      return validatePly(file);
    case MeshFormat::kGltf:
    case MeshFormat::kGlb:
      return validateGltf(file, format == MeshFormat::kGlb);
  }
  return {};
}

}  // namespace taxelsim
