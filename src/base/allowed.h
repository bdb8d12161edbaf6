// The numbers that a setting may have, for checks, for reading and for messages.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace taxelsim {

// An interval, in SI units.
struct Allowed {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;  // excludes min
  bool below_max = false;  // excludes max
  std::string_view unit = "";

  static constexpr Allowed any(std::string_view unit) { return {.unit = unit}; }
  static constexpr Allowed atLeast(double min, std::string_view unit) { return {.min = min, .unit = unit}; }
  static constexpr Allowed above(double min, std::string_view unit) { return {.min = min, .above_min = true, .unit = unit}; }
  static constexpr Allowed within(double min, double max, std::string_view unit) { return {.min = min, .max = max, .unit = unit}; }
  static constexpr Allowed aboveUpTo(double min, double max, std::string_view unit) {
    return {.min = min, .max = max, .above_min = true, .unit = unit};
  }
};

// False for NaN and infinities.
bool isAllowed(double value, const Allowed& allowed);

// "a number > 0 m", "a number from 0 to 1".
std::string describe(const Allowed& allowed);

// Bounds of a whole number that is not negative; the lower bound must be >= 0.
std::uint64_t minWhole(const Allowed& allowed);
std::uint64_t maxWhole(const Allowed& allowed);

// "a whole number from 1 to 128".
std::string describeWhole(const Allowed& allowed);

}  // namespace taxelsim
