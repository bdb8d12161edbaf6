// Units of numbers in files: SI, or by the end of the key millimetres or degrees.
#pragma once

#include <string>
#include <string_view>

#include "base/allowed.h"

namespace taxelsim {

enum class FileUnit { kSi, kMilli, kDegree };

// Of a key that ends in "_mm", in "_deg", or in neither.
FileUnit unitOfSuffix(std::string_view suffix);

// A value, SI, in that unit. Rounding removes the last bits of pi / 180, so that 90 deg is 90.
double inUnit(double value, FileUnit unit);

// The allowed numbers in that unit. `name`: receives the name of the unit, to which the result refers.
Allowed inUnit(const Allowed& allowed, FileUnit unit, std::string& name);

}  // namespace taxelsim
