#include "characterize/statistics.h"

#include <cmath>
#include <limits>

namespace taxelsim {

bool isBetterFit(double squares, double squares_with_more, double more, double freedom, double chance) {
  if (!(freedom > 0) || !(squares > squares_with_more)) return false;
  if (!(squares_with_more > 0)) return true;
  // F as a Gaussian: M. Abramowitz and I. Stegun, Handbook of Mathematical Functions, 26.6.15.
  const double root = std::cbrt((squares - squares_with_more) / more / (squares_with_more / freedom));
  const double a = 2 / (9 * freedom), b = 2 / (9 * more);
  return ((1 - a) * root - (1 - b)) / std::sqrt(a * root * root + b) > chance;
}

double studentFactor(std::size_t degrees_of_freedom) {
  constexpr double kNormal = 1.959963985;
  if (degrees_of_freedom == 0) return std::numeric_limits<double>::infinity();
  if (degrees_of_freedom == 1) return 12.7062;
  if (degrees_of_freedom == 2) return 4.3027;
  const double n = static_cast<double>(degrees_of_freedom), x = kNormal, x2 = x * x;
  return x + x * (x2 + 1) / (4 * n) + x * ((5 * x2 + 16) * x2 + 3) / (96 * n * n) +
         x * (((3 * x2 + 19) * x2 + 17) * x2 - 15) / (384 * n * n * n);
}

}  // namespace taxelsim
