// Checks of settings that come from callers. Not of what a running controller computes.
#pragma once

#include <cmath>

namespace taxelsim {

inline bool isAtLeastZero(double value) {
  return std::isfinite(value) && value >= 0;
}
inline bool isPositive(double value) {
  return std::isfinite(value) && value > 0;
}

// Throws Error(kInput), "what: field: value is not allowed: allowed", unless `holds`.
void requireValue(bool holds, const char* what, const char* field, double value, const char* allowed);

}  // namespace taxelsim
