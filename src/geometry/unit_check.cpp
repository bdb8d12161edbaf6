#include "geometry/unit_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace taxelsim {

std::string implausibleSize(const Bounds& bounds, const std::string& if_long, const std::string& if_short) {
  double longest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) longest = std::max(longest, bounds.max[axis] - bounds.min[axis]);
  const bool is_plausible = longest >= kShortestPlausible && longest <= kLongestPlausible;
  if (is_plausible || longest == 0 || !std::isfinite(longest)) return {};
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "is %.3g m long; ", longest);
  return text.data() + (longest > kLongestPlausible ? if_long : if_short);
}

}  // namespace taxelsim
