// Units of numbers in files: SI, or by the end of the key millimetres or degrees.
#pragma once

#include <string>
#include <string_view>

#include "base/allowed.h"

namespace taxelsim {

enum class FileUnit { kSi, kMilli, kDegree };

// Gives the unit of a key that ends in `suffix`: "_mm", "_deg", or another.
FileUnit unitOfSuffix(std::string_view suffix);

// Converts a value from SI. Rounding removes the last bits of pi / 180, so that 90 deg is 90.
double inUnit(double value, FileUnit unit);

// Converts the limits of the allowed numbers from SI. `name`: receives the name of the unit, to which the result refers.
Allowed inUnit(const Allowed& allowed, FileUnit unit, std::string& name);

}  // namespace taxelsim
