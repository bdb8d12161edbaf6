#include "geometry/number_type.h"

#include <array>
#include <bit>

namespace taxelsim {

bool isFloat(NumberType type) {
  return type == NumberType::kFloat32 || type == NumberType::kFloat64;
}

std::size_t sizeOf(NumberType type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

double valueOf(NumberType type, std::uint64_t bits) {
  switch (type) {
    case NumberType::kInt8:
      return static_cast<std::int8_t>(bits);
    case NumberType::kUint8:
      return static_cast<std::uint8_t>(bits);
    case NumberType::kInt16:
      return static_cast<std::int16_t>(bits);
    case NumberType::kUint16:
      return static_cast<std::uint16_t>(bits);
    case NumberType::kInt32:
      return static_cast<std::int32_t>(bits);
    case NumberType::kUint32:
      return static_cast<std::uint32_t>(bits);
    case NumberType::kFloat32:
      return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    case NumberType::kFloat64:
      break;
  }
  return std::bit_cast<double>(bits);
}

}  // namespace taxelsim
