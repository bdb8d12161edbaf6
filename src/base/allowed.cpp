#include "base/allowed.h"

#include <cmath>

#include "base/text.h"

namespace taxelsim {

bool isAllowed(double value, const Allowed& allowed) {
  return std::isfinite(value) && value >= allowed.min && value <= allowed.max && !(allowed.above_min && value == allowed.min) &&
         !(allowed.below_max && value == allowed.max);
}

std::string describe(const Allowed& allowed) {
  const auto& [min, max, above_min, below_max, unit] = allowed;
  std::string text = "a number";
  if (std::isfinite(min) && std::isfinite(max) && !above_min && !below_max) {
    text += " from " + numberText(min) + " to " + numberText(max);
  } else {
    if (std::isfinite(min)) text += (above_min ? " > " : " >= ") + numberText(min);
    if (std::isfinite(max)) text += (std::isfinite(min) ? " and" : "") + std::string(below_max ? " < " : " <= ") + numberText(max);
  }
  return unit.empty() ? text : text + " " + std::string(unit);
}

std::uint64_t minWhole(const Allowed& allowed) {
  return static_cast<std::uint64_t>(allowed.min);
}

std::uint64_t maxWhole(const Allowed& allowed) {
  constexpr double kOverflow = 0x1p64;  // the first double that does not fit
  return allowed.max < kOverflow ? static_cast<std::uint64_t>(allowed.max) : std::numeric_limits<std::uint64_t>::max();
}

std::string describeWhole(const Allowed& allowed) {
  return "a whole number from " + std::to_string(minWhole(allowed)) + " to " + std::to_string(maxWhole(allowed));
}

}  // namespace taxelsim
