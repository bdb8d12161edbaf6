#include "geometry/unit_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace taxelsim {

std::string implausibleSize(const Bounds& bounds) {
  double longest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) longest = std::max(longest, bounds.max[axis] - bounds.min[axis]);
  if (!(longest > kLongestPlausible && std::isfinite(longest))) return {};
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "is %.3g m long", longest);
  return text.data();
}

}  // namespace taxelsim
