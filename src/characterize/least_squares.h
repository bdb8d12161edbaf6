// Robust nonlinear least squares with intervals, over rows, or over groups of rows that share some parameters and have others of their own,
// such as images of one sensor, each under a load of its own: by Ceres, with the groups' own parameters eliminated.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

namespace taxelsim {

struct FitParameter {
  double start = 0;
  double scale = 1;  // > 0: a typical size of it; what is fitted is parameter / scale
  double low = -1e300;
  double high = 1e300;
};

// A parameter whose bounds are one and the same stays.
struct GroupedProblem {
  std::vector<FitParameter> shared;
  std::vector<std::vector<FitParameter>> own;  // (groups)
  std::vector<std::size_t> num_rows;           // (groups)

  // Standard deviation of the rows where it is known; they are taken to have no less. 0: as they show. Of use where many are pinned by an
  // end of their range and tell nothing of it.
  double noise = 0;

  // Writes the residuals of one group, (its rows), all of one standard deviation.
  std::function<void(std::size_t group, const double* shared, const double* own, double* residuals)> residuals;
};

struct GroupedFit {
  std::vector<double> shared;
  std::vector<std::vector<double>> own;           // (groups)
  Eigen::MatrixXd covariance;                     // of the shared values
  std::vector<std::vector<double>> own_variance;  // (groups)
  std::vector<std::vector<double>> residual;      // (groups, rows)
  std::vector<std::vector<bool>> outlier;         // (groups, rows)
  double residual_sd = 0;                         // of rows that are no outliers
  std::size_t num_rows = 0;
  std::size_t num_outliers = 0;
  std::size_t degrees_of_freedom = 0;

  // Half the width of the 95 % interval, by Student's distribution; infinite where the rows do not tell.
  double halfWidth(std::size_t shared_parameter) const;
  double ownHalfWidth(std::size_t group, std::size_t parameter) const;
  // The same of what depends on the shared values as `gradient` says.
  double halfWidthOf(const Eigen::VectorXd& gradient) const;
  // The same of a mean over groups of what depends on a group's own parameters as `own_gradients` say, one a group, and on the shared ones.
  double meanHalfWidth(const std::vector<Eigen::VectorXd>& own_gradients, const Eigen::VectorXd& shared_gradient) const;

  std::vector<Eigen::MatrixXd> own_covariance;  // (groups): with the shared values held
  std::vector<Eigen::MatrixXd> lean;            // (groups): how far own values fall as shared ones rise, (own x shared)
  std::vector<Eigen::MatrixXd> response;        // (groups): how far shared values fall as a residual rises, (shared x rows)
};

// Parameters that make the sum of squares of the residuals least over the rows that are no outliers: first under Cauchy's loss, which
// outliers do not move, then without the rows farther than 4.5 standard deviations (of the median's) from it. Of parameters that the rows
// do not tell apart the variances are infinite, of the others they are those with the former where they ended. Deterministic.
GroupedFit fitGroups(const GroupedProblem& problem);

// Sum of squares of a fit's residuals, each cut off at 3 `deviation`: of models of the same rows, whatever each calls an outlier.
double cutSquares(const GroupedFit& fit, double deviation);

inline constexpr double kOneInAThousand = 3.0902;  // standard deviations of a Gaussian, one side
inline constexpr double kOneInTwenty = 1.6449;

// Whether a model of `more` further parameters is better than chance allows, in one case of a thousand, or another: the F test between sums
// of squares of the same rows, with `freedom` degrees left to the larger model.
bool isBetterFit(double squares, double squares_with_more, double more, double freedom, double chance = kOneInAThousand);

struct FitResult {
  std::vector<double> values;
  Eigen::MatrixXd covariance;  // of the values; all infinite where the rows do not tell them apart
  double residual_sd = 0;      // standard deviation of the residuals of rows that are no outliers
  std::vector<bool> outlier;   // (rows)
  std::size_t num_outliers = 0;
  std::size_t degrees_of_freedom = 0;

  // Half the width of the 95 % interval of a value, by Student's distribution; infinite where the rows do not tell.
  double halfWidth(std::size_t parameter) const;
};

// The same of one group of rows, all parameters its own.
FitResult fitRows(std::size_t num_rows, const std::vector<FitParameter>& parameters,
                  const std::function<double(std::size_t row, const double* values)>& residual);

// Factor of a standard error that makes half of a 95 % interval; M. Abramowitz and I. Stegun, Handbook of Mathematical Functions, 26.7.5.
double studentFactor(std::size_t degrees_of_freedom);

double medianOf(std::vector<double> values);  // of nothing 0

}  // namespace taxelsim
