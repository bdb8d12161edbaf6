#include "geometry/ply_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMinTextBytes = 2;  // of a value: a digit and a blank

[[noreturn]] void failAtEnd() {
  throw PlyProblem{"it ends before the last element that its header or a list claims"};
}

}  // namespace

std::optional<NumberType> plyType(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, NumberType>, 16> kNames{{{"char", NumberType::kInt8},
                                                                                   {"int8", NumberType::kInt8},
                                                                                   {"uchar", NumberType::kUint8},
                                                                                   {"uint8", NumberType::kUint8},
                                                                                   {"short", NumberType::kInt16},
                                                                                   {"int16", NumberType::kInt16},
                                                                                   {"ushort", NumberType::kUint16},
                                                                                   {"uint16", NumberType::kUint16},
                                                                                   {"int", NumberType::kInt32},
                                                                                   {"int32", NumberType::kInt32},
                                                                                   {"uint", NumberType::kUint32},
                                                                                   {"uint32", NumberType::kUint32},
                                                                                   {"float", NumberType::kFloat32},
                                                                                   {"float32", NumberType::kFloat32},
                                                                                   {"double", NumberType::kFloat64},
                                                                                   {"float64", NumberType::kFloat64}}};
  const auto found = std::find_if(kNames.begin(), kNames.end(), [&](const auto& entry) { return entry.first == name; });
  return found == kNames.end() ? std::nullopt : std::optional(found->second);
}

std::string_view PlyWords::next() {
  constexpr const char* kBlanks = " \t\r\n\v\f";
  const std::size_t begin = std::min(text_.find_first_not_of(kBlanks, at_), text_.size());
  at_ = std::min(text_.find_first_of(kBlanks, begin), text_.size());
  return text_.substr(begin, at_ - begin);
}

double PlyBody::read(NumberType type) {
  if (encoding_ == PlyEncoding::kText) {
    const std::string_view word = words_.next();
    double value = 0;
    if (word.empty()) failAtEnd();
    if (!parseNumber(word.substr(word[0] == '+' ? 1 : 0), value))
      throw PlyProblem{"it has the value " + oneLine(word).substr(0, kMaxShown) + ", which is not a finite number"};
    return value;
  }
  const std::size_t size = sizeOf(type);
  if (bytes_.size() < size) failAtEnd();
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t byte = encoding_ == PlyEncoding::kLittle ? size - 1 - i : i;
    bits = bits << 8 | static_cast<unsigned char>(bytes_[byte]);
  }
  bytes_.remove_prefix(size);
  return valueOf(type, bits);
}

void PlyBody::expectRows(std::uint64_t count, std::span<const NumberType> types) const {
  const bool is_text = encoding_ == PlyEncoding::kText;
  std::size_t row_bytes = 0;
  for (const NumberType type : types) row_bytes += is_text ? kMinTextBytes : sizeOf(type);
  const std::size_t left = is_text ? words_.numBytesLeft() + 1 : bytes_.size();  // the last blank can be missing
  if (row_bytes > 0 && count > left / row_bytes) failAtEnd();
}

std::uint64_t PlyBody::readCount(NumberType count_type, NumberType value_type) {
  const double count = read(count_type);
  if (!(count >= 0) || count != std::floor(count)) throw PlyProblem{"it has a list of " + numberText(count) + " values"};
  if (count > static_cast<double>(kMaxMeshFileBytes)) failAtEnd();
  expectRows(static_cast<std::uint64_t>(count), {&value_type, 1});
  return static_cast<std::uint64_t>(count);
}

}  // namespace taxelsim
