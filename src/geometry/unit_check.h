// Lengths that were probably given in another unit than metres.
#pragma once

#include <string>

#include "taxelsim/object.h"

namespace taxelsim {

// m. Hands hold what is shorter, and no sensor has a larger pitch: a longer object is probably in millimetres, or scaled to a length of 1.
inline constexpr double kLongestPlausible = 0.7;
// m, a tenth of a small taxel. A shorter object was probably scaled twice.
inline constexpr double kShortestPlausible = 1e-4;

// "is 35 m long; " and `if_long` for an object whose longest side along x, y or z is above kLongestPlausible, the same with `if_short`
// below kShortestPlausible; empty for any other one, for a half-space and for an empty mesh.
std::string implausibleSize(const Bounds& bounds, const std::string& if_long, const std::string& if_short);

}  // namespace taxelsim
