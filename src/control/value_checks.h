// Range checks for settings.
#pragma once

#include <cmath>

namespace taxelsim {

inline bool isAtLeastZero(double value) {
  return std::isfinite(value) && value >= 0;
}
inline bool isPositive(double value) {
  return std::isfinite(value) && value > 0;
}

// Throws Error(kInput) with the message "object: field: value is not allowed: allowed" unless `is_valid`.
void requireValue(bool is_valid, const char* object, const char* field, double value, const char* allowed);

}  // namespace taxelsim
