// The interface of a pass as a C++ type: its specialization constants are fields, its buffers are blocks. A pass type comes from a list
// that the shader reads too, so both sides have the same ids, bindings and types. It has
//   a field SpecConstant<id, T> NAME for every specialization constant, in the order of ids;
//   a declaration SpecConstant<id, T> constantAt(At<id>) for each of them;
//   a declaration Block blockAt(At<binding>) for every buffer.
// A block is a type with `static constexpr const char* kName`, the block's name in the shader, and `static constexpr std::size_t kIndex`.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "gpu/kernel.h"

namespace taxelsim::gpu {

// A number as a type.
template <std::uint32_t kNumber>
struct At {};

// Bool, integer and floating-point values do not convert into each other.
template <typename Value, typename T>
concept SameKind = std::is_arithmetic_v<Value> &&
    (std::same_as<Value, bool> == std::same_as<T, bool>)&&(std::floating_point<Value> == std::floating_point<T>);

// Value of the specialization constant `kId`, of 32 bits. Has no default: a pass type must be given every one.
template <std::uint32_t kId, typename T>
struct SpecConstant : Constant {
  static_assert(std::same_as<T, bool> || std::same_as<T, float> || std::same_as<T, std::uint32_t> || std::same_as<T, std::int32_t>);

  // Throws std::logic_error for an integer outside of T.
  template <SameKind<T> Value>
  constexpr SpecConstant(Value number)
      : Constant{kId, bitsOf(number)} {}  // NOLINT(google-explicit-constructor): for designated initialisers

 private:
  template <typename Value>
  static constexpr std::uint32_t bitsOf(Value number) {
    if constexpr (std::floating_point<T>) return std::bit_cast<std::uint32_t>(static_cast<float>(number));
    if constexpr (std::integral<Value> && !std::same_as<Value, bool>) {
      if (!std::in_range<T>(number)) throw std::logic_error("specialization constant " + std::to_string(kId) + " is out of range");
    }
    return static_cast<std::uint32_t>(number);
  }
};

// How many constants of Pass have the ids kFirst, kFirst + 1, ...
template <typename Pass, std::uint32_t kFirst>
consteval std::uint32_t countConstantsFrom() {
  if constexpr (requires { Pass::constantAt(At<kFirst>{}); }) {
    return 1 + countConstantsFrom<Pass, kFirst + 1>();
  } else {
    return 0;
  }
}

// The fields of a pass type as a list. `kFirst`: the lowest id.
template <std::uint32_t kFirst, typename Pass>
constexpr auto constantsOf(const Pass& constants) {
  constexpr std::uint32_t kCount = countConstantsFrom<Pass, kFirst>();
  static_assert(sizeof(Pass) == kCount * sizeof(Constant), "ids of specialization constants must be contiguous");
  return std::bit_cast<std::array<Constant, kCount>>(constants);
}

// How many buffers Pass has at kFirst, kFirst + 1, ...
template <typename Pass, std::uint32_t kFirst = 0>
consteval std::uint32_t countBuffers() {
  if constexpr (requires { Pass::blockAt(At<kFirst>{}); }) {
    return 1 + countBuffers<Pass, kFirst + 1>();
  } else {
    return 0;
  }
}

template <typename Pass, std::uint32_t kBinding>
using BlockAt = decltype(Pass::blockAt(At<kBinding>{}));

}  // namespace taxelsim::gpu
