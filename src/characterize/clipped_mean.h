// What readings average to where the converter's ends cut their noise off.
#pragma once

#include <cmath>
#include <numbers>

namespace taxelsim {

inline constexpr double kLeastNoise = 0.288675;  // counts: what rounding alone makes, 1 / sqrt(12)
inline constexpr double kFarNoise = 4;           // standard deviations past an end, where a reading tells no more than that it is past it

// What a reading of `mean` counts with Gaussian noise (counts, > 0) is on average after it was clipped to [0, top].
inline double clippedMean(double mean, double noise, double top) {
  constexpr double kNotClipped = 6;  // standard deviations from both ends
  if (mean > kNotClipped * noise && mean < top - kNotClipped * noise) return mean;
  if (mean < -kNotClipped * noise) return 0;
  const auto density = [](double x) { return std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi); };
  const auto below = [](double x) { return std::erfc(-x / std::numbers::sqrt2) / 2; };
  const double a = -mean / noise, b = (top - mean) / noise;
  return mean * (below(b) - below(a)) - noise * (density(b) - density(a)) + top * (1 - below(b));
}

// Whether a reading at an end tells nothing more of its mean.
inline bool isFarPastEnd(double mean, double counts, double noise, double top) {
  return (mean < -kFarNoise * noise && counts <= 0) || (mean > top + kFarNoise * noise && counts >= top);
}

}  // namespace taxelsim
