// Robust nonlinear least squares with confidence intervals.
//
// Rows form groups. All groups share some parameters, and each group has parameters of its own; an example is a set of images of one
// sensor, each under its own load. The solver eliminates the groups' own parameters (Schur complement).
// Eigen is part of the interface: callers multiply covariances and gradients whose sizes are known at run time.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

#include "characterize/statistics.h"

namespace taxelsim {

struct FitParameter {
  double start = 0;
  double scale = 1;  // > 0: typical size; the solver works on parameter / scale
  double low = -1e300;
  double high = 1e300;
};

// A parameter with low >= high is constant.
struct GroupedProblem {
  std::vector<FitParameter> shared;
  std::vector<std::vector<FitParameter>> own;  // (groups)
  std::vector<std::size_t> num_rows;           // (groups)

  // Lower bound of the residuals' standard deviation; 0 for none. Needed if many rows are clipped, because clipped rows have residuals of
  // 0.
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
  double residual_sd = 0;                         // without outliers
  std::size_t num_rows = 0;
  std::size_t num_outliers = 0;
  std::size_t degrees_of_freedom = 0;

  // Half width of the 95 % confidence interval (Student); infinite for a parameter that is not identifiable.
  double halfWidth(std::size_t shared_parameter) const;
  double ownHalfWidth(std::size_t group, std::size_t parameter) const;
  // The same for a function of the shared values with this gradient.
  double halfWidthOf(const Eigen::VectorXd& gradient) const;
  // The same for a mean over groups of a function with gradient own_gradients[g] in the own values of group g and `shared_gradient` in the
  // shared values.
  double meanHalfWidth(const std::vector<Eigen::VectorXd>& own_gradients, const Eigen::VectorXd& shared_gradient) const;

  std::vector<Eigen::MatrixXd> own_covariance;  // (groups): for fixed shared values
  std::vector<Eigen::MatrixXd> own_by_shared;   // (groups): -d(own) / d(shared), (own x shared)
  std::vector<Eigen::MatrixXd> response;        // (groups): -d(shared) / d(residual), (shared x rows)
};

// Minimises the sum of squared residuals without outliers. First come iterations with Cauchy weights, which are robust to outliers; then
// rows beyond 4.5 robust standard deviations are removed and the rest is fitted without weights. Parameters outside the identifiable
// subspace have infinite variance; the variances of the others assume that these stay at their final values. Deterministic.
GroupedFit fitGroups(const GroupedProblem& problem);

// Sum of squared residuals, each clipped at 3 `deviation`. Compares models on the same rows, whichever rows each takes for outliers.
double cutSquares(const GroupedFit& fit, double deviation);

struct FitResult {
  std::vector<double> values;
  Eigen::MatrixXd covariance;  // infinite for parameters that are not identifiable
  double residual_sd = 0;      // without outliers
  std::vector<bool> outlier;   // (rows)
  std::size_t num_outliers = 0;
  std::size_t degrees_of_freedom = 0;

  // Half width of the 95 % confidence interval (Student); infinite for a parameter that is not identifiable.
  double halfWidth(std::size_t parameter) const;
};

// fitGroups() for a single group without own parameters.
FitResult fitRows(std::size_t num_rows, const std::vector<FitParameter>& parameters,
                  const std::function<double(std::size_t row, const double* values)>& residual);

}  // namespace taxelsim
