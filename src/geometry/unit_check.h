// Lengths that were probably given in millimetres where metres are expected.
#pragma once

#include <string>

#include "taxelsim/object.h"

namespace taxelsim {

// m; a longer object, or a pitch above it, is probably in millimetres: tactile sensors and what they touch are smaller.
inline constexpr double kLongestPlausible = 1;

// "is 35 m long" for an object with bounds longer than kLongestPlausible along x, y or z; empty for any other one, and for a half-space.
std::string implausibleSize(const Bounds& bounds);

}  // namespace taxelsim
