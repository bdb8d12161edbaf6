// Expected readings of a converter that clips noise at the ends of its range.
#pragma once

#include <cmath>
#include <numbers>

namespace taxelsim {

inline constexpr double kLeastNoise = 0.288675;  // counts: standard deviation of rounding, 1 / sqrt(12)
inline constexpr double kFarNoise = 4;           // standard deviations beyond an end of the range

// Mean of a Gaussian with this mean and standard deviation `noise` > 0 after clipping to [0, top]; all in counts.
inline double clippedMean(double mean, double noise, double top) {
  constexpr double kNotClipped = 6;  // standard deviations from both ends
  if (mean > kNotClipped * noise && mean < top - kNotClipped * noise) return mean;
  if (mean < -kNotClipped * noise) return 0;
  const auto density = [](double x) { return std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi); };
  const auto below = [](double x) { return std::erfc(-x / std::numbers::sqrt2) / 2; };
  const double a = -mean / noise, b = (top - mean) / noise;
  return mean * (below(b) - below(a)) - noise * (density(b) - density(a)) + top * (1 - below(b));
}

// True for a reading at an end of the range that is uninformative, because its mean is far beyond that end.
inline bool isFarPastEnd(double mean, double counts, double noise, double top) {
  return (mean < -kFarNoise * noise && counts <= 0) || (mean > top + kFarNoise * noise && counts >= top);
}

}  // namespace taxelsim
