// One weighted least-squares solve of a GroupedProblem, and its Jacobians.
// Eigen is part of the interface: Jacobians have sizes known at run time.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "characterize/least_squares.h"

namespace taxelsim {

using RowWeights = std::vector<std::vector<double>>;  // (groups, rows)

struct ParameterValues {
  std::vector<double> shared;
  std::vector<std::vector<double>> own;  // (groups)
};

struct SolveLimits {
  double tolerance = 0;  // relative change of the sum of squares
  int max_iterations = 0;
};

// Minimises the sum of (weight x residual)^2 from `values`, which receives the result.
void solveWeighted(const GroupedProblem& problem, const RowWeights& weights, const SolveLimits& limits, ParameterValues& values);

// Jacobians of one group's weighted residuals by the scaled parameters.
struct GroupJacobians {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  RowMajor shared;  // (rows x shared)
  RowMajor own;     // (rows x own)
};
GroupJacobians jacobiansOf(const GroupedProblem& problem, std::size_t group, const std::vector<double>& weights,
                           const ParameterValues& values);

}  // namespace taxelsim
