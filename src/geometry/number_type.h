// Types of numbers in binary mesh files.
#pragma once

#include <cstddef>
#include <cstdint>

namespace taxelsim {

enum class NumberType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

bool isFloat(NumberType type);

// Bytes of a number.
std::size_t sizeOf(NumberType type);

// The number with these bits; bits beyond its size are ignored.
double valueOf(NumberType type, std::uint64_t bits);

}  // namespace taxelsim
