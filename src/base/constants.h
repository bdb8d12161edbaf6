// Numbers that sources of several rooms share.
#pragma once

#include <limits>
#include <numbers>

namespace taxelsim {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kRadPerDegree = std::numbers::pi / 180;  // rad

}  // namespace taxelsim
