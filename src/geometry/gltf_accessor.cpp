#include "geometry/gltf_accessor.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "base/files.h"
#include "geometry/binary_file.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

// The bytes that `digits` encode in base 64; none if they are not base 64.
std::optional<std::string> decodeBase64(std::string_view digits) {
  static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  digits = digits.substr(0, digits.find('='));
  std::string bytes;
  bytes.reserve(digits.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int num_bits = 0;
  for (const char digit : digits) {
    const std::size_t value = kDigits.find(digit);
    if (value == std::string_view::npos) return {};
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    num_bits += 6;
    if (num_bits < 8) continue;
    num_bits -= 8;
    bytes += static_cast<char>(bits >> num_bits);
  }
  return bytes;
}

// Replaces %20 and the like.
std::string decodePercents(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned code = 0;
    const bool is_code =
        uri[i] == '%' && i + 2 < uri.size() && std::from_chars(&uri[i + 1], &uri[i + 1] + 2, code, 16).ptr == &uri[i + 1] + 2;
    text += is_code ? static_cast<char>(code) : uri[i];
    if (is_code) i += 2;
  }
  return text;
}

std::string countOf(std::uint64_t count, const char* what) {
  return std::to_string(count) + " " + what;
}

std::size_t numComponents(const GltfItem& accessor) {
  static constexpr std::array<std::pair<std::string_view, std::size_t>, 7> kTypes{
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
  const std::string type = accessor.text("type");
  for (const auto& [name, count] : kTypes) {
    if (type == name) return count;
  }
  accessor.refuse("type", "SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
}

NumberType numberTypeOf(const GltfItem& accessor) {
  static constexpr std::array<std::pair<std::uint64_t, NumberType>, 6> kTypes{{{5120, NumberType::kInt8},
                                                                               {5121, NumberType::kUint8},
                                                                               {5122, NumberType::kInt16},
                                                                               {5123, NumberType::kUint16},
                                                                               {5125, NumberType::kUint32},
                                                                               {5126, NumberType::kFloat32}}};
  const std::uint64_t code = accessor.whole("componentType", kMaxMeshFileBytes);
  for (const auto& [name, type] : kTypes) {
    if (code == name) return type;
  }
  accessor.refuse("componentType", "5120 to 5123, 5125 or 5126");
}

}  // namespace

GltfBuffers::GltfBuffers(const GltfItem& root, std::filesystem::path file, std::optional<std::string_view> binary_chunk)
    : root_(root), file_(std::move(file)), binary_chunk_(binary_chunk), loaded_(root.size("buffers")) {}

std::string_view GltfBuffers::bytes(std::size_t buffer) {
  const GltfItem item = root_.entry("buffers", buffer);
  const std::size_t size = item.whole("byteLength", kMaxMeshFileBytes);
  std::string_view bytes;
  if (item.has("uri")) {
    if (!loaded_[buffer]) loaded_[buffer] = load(item, item.text("uri"), size);
    bytes = *loaded_[buffer];
  } else {
    if (!binary_chunk_ || buffer != 0) item.refuse("uri", "the place of the bytes");
    bytes = *binary_chunk_;
  }
  if (bytes.size() < size) item.refuse("byteLength", "at most " + countOf(bytes.size(), "bytes, which the buffer has"));
  return bytes.substr(0, size);
}

std::string GltfBuffers::load(const GltfItem& buffer, const std::string& uri, std::size_t size) {
  if (!uri.starts_with("data:")) return loadFile(buffer, uri, size);
  static constexpr std::string_view kMark = ";base64,";
  const std::size_t comma = uri.find(',');
  const bool is_base64 = comma != std::string::npos && std::string_view(uri).substr(0, comma + 1).ends_with(kMark);
  std::optional<std::string> bytes = is_base64 ? decodeBase64(std::string_view(uri).substr(comma + 1)) : std::nullopt;
  if (!bytes) buffer.refuse("uri", "data in base 64");
  return std::move(*bytes);
}

std::string GltfBuffers::loadFile(const GltfItem& buffer, const std::string& uri, std::size_t size) {
  if (binary_chunk_) {
    throw GltfProblem{buffer.path() + " is in another file (\"" + shownGltfText(uri) +
                      "\"), which its SHA-256 does not cover: save it with all buffers inside"};
  }
  const std::filesystem::path file = file_.parent_path() / std::filesystem::path(decodePercents(uri)).relative_path();
  std::string problem = inputFileProblem(file, kMaxMeshFileBytes);
  num_file_bytes_ += size;
  if (problem.empty() && num_file_bytes_ > kMaxMeshFileBytes)
    problem = "more bytes than " + std::to_string(kMaxMeshFileBytes) + " in all buffers";
  if (!problem.empty()) throw GltfProblem{buffer.path() + ".uri: \"" + shownGltfText(uri) + "\": " + problem};
  return readStart(file, size);
}

GltfAccessor::GltfAccessor(const GltfItem& root, std::size_t accessor, GltfBuffers& buffers)
    : item_(root.entry("accessors", accessor)),
      count_(item_.whole("count", kMaxMeshFileBytes)),
      number_(numberTypeOf(item_)),
      type_(item_.text("type")),
      is_normalized_(item_.flag("normalized", false)) {
  const std::size_t element_size = numComponents(item_) * sizeOf(number_);
  if (count_ == 0) item_.refuse("count", "a whole number >= 1");
  if (item_.has("sparse")) item_.refuse("sparse", "all elements in a bufferView; save the mesh without sparse accessors");
  const GltfItem view = root.entry("bufferViews", item_.index("bufferView", "bufferViews", root.size("bufferViews")));
  const std::string_view buffer = buffers.bytes(view.index("buffer", "buffers", root.size("buffers")));
  const std::size_t view_begin = view.whole("byteOffset", buffer.size(), 0);
  const std::size_t view_size = view.whole("byteLength", buffer.size() - view_begin);
  stride_ = view.whole("byteStride", kMaxMeshFileBytes, element_size);
  if (stride_ < element_size) view.refuse("byteStride", "at least " + countOf(element_size, "bytes, the length of an element"));
  const std::size_t begin = item_.whole("byteOffset", view_size, 0);
  const std::uint64_t end = begin + (count_ - 1) * stride_ + element_size;  // each factor is at most 2^30
  if (end > view_size) {
    item_.refuse("count", "its last element ends at byte " + std::to_string(end) + " of a bufferView of " + countOf(view_size, "bytes"));
  }
  bytes_ = buffer.substr(view_begin + begin, end - begin);
}

double GltfAccessor::value(std::size_t element, std::size_t component) const {
  const std::size_t size = sizeOf(number_);
  const double value = valueOf(number_, readLittleEndian(bytes_.substr(element * stride_ + component * size, size)));
  if (!is_normalized_ || isFloat(number_)) return value;
  const bool is_signed = number_ == NumberType::kInt8 || number_ == NumberType::kInt16;
  const double largest = std::exp2(8.0 * static_cast<double>(size) - (is_signed ? 1 : 0)) - 1;
  return std::max(value / largest, -1.0);
}

}  // namespace taxelsim
