#include "characterize/weighted_solve.h"

#include "characterize/group_residuals.h"
#include "characterize/solvers.h"

namespace taxelsim {

void solveWeighted(const GroupedProblem& problem, const RowWeights& weights, const SolveLimits& limits, ParameterValues& values) {
#ifdef TAXELSIM_HAS_CERES
  solveWithCeres(problem, weights, limits, values);
#else
  solveWithEigen(problem, weights, limits, values);
#endif
}

GroupJacobians jacobiansOf(const GroupedProblem& problem, std::size_t group, const std::vector<double>& weights,
                           const ParameterValues& values) {
  const auto rows = static_cast<Eigen::Index>(problem.num_rows[group]);
  const std::vector<FitParameter>&shared_parameters = problem.shared, &own_parameters = problem.own[group];
  GroupJacobians result;
  result.shared.setZero(rows, static_cast<Eigen::Index>(shared_parameters.size()));
  result.own.setZero(rows, static_cast<Eigen::Index>(own_parameters.size()));
  std::vector<double> shared, own, residuals(problem.num_rows[group]);
  for (std::size_t p = 0; p < shared_parameters.size(); ++p) shared.push_back(values.shared[p] / shared_parameters[p].scale);
  for (std::size_t p = 0; p < own_parameters.size(); ++p) own.push_back(values.own[group][p] / own_parameters[p].scale);
  GroupResiduals(problem, group, weights).evaluate(shared.data(), own.data(), residuals.data(), result.shared.data(), result.own.data());
  return result;
}

}  // namespace taxelsim
