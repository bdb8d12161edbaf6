#include "sensor/allowed.h"

#include <cmath>

#include "base/text.h"

namespace taxelsim {

bool isAllowed(double value, const Allowed& allowed) {
  return std::isfinite(value) && value >= allowed.min && value <= allowed.max && !(allowed.above_min && value == allowed.min);
}

std::string describe(const Allowed& allowed) {
  const auto& [min, max, above_min, unit] = allowed;
  std::string text = "a number";
  if (std::isfinite(min) && std::isfinite(max) && !above_min) {
    text += " from " + numberText(min) + " to " + numberText(max);
  } else {
    if (std::isfinite(min)) text += (above_min ? " > " : " >= ") + numberText(min);
    if (std::isfinite(max)) text += (std::isfinite(min) ? " and <= " : " <= ") + numberText(max);
  }
  return unit.empty() ? text : text + " " + std::string(unit);
}

std::string describeWhole(const Allowed& allowed) {
  return "a whole number from " + numberText(allowed.min) + " to " + numberText(allowed.max);
}

}  // namespace taxelsim
