// Numbers that sources of several rooms share.
#pragma once

#include <limits>
#include <numbers>

namespace taxelsim {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kRadPerDegree = std::numbers::pi / 180;  // rad

// A quaternion read from text with six digits is this close to unit length.
inline constexpr double kQuaternionTolerance = 1e-3;

}  // namespace taxelsim
