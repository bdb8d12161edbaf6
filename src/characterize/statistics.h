// Statistics of fits: quantiles, robust estimates, comparison of nested models.
#pragma once

#include <cstddef>
#include <vector>

#include "base/median.h"

namespace taxelsim {

// Standard deviation / median absolute deviation of a Gaussian.
inline constexpr double kMedianToDeviation = 1.482602;

// One-sided quantiles of a standard normal distribution: chance 0.001 and 0.05.
inline constexpr double kOneInAThousand = 3.0902;
inline constexpr double kOneInTwenty = 1.6449;

// F test of nested models on the same rows. `squares` and `squares_with_more` are the residual sums of squares, `more` the number of
// additional parameters, `freedom` the degrees of freedom of the larger model. True if the improvement has a lower probability than
// `chance` (a quantile of the standard normal distribution) under the smaller model.
bool isBetterFit(double squares, double squares_with_more, double more, double freedom, double chance = kOneInAThousand);

// Student's 97.5 % quantile: half width of a 95 % confidence interval in standard errors; infinite for 0 degrees of freedom.
// M. Abramowitz and I. Stegun, Handbook of Mathematical Functions, 26.7.5.
double studentFactor(std::size_t degrees_of_freedom);

}  // namespace taxelsim
