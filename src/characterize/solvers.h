// The solvers behind solveWeighted(), which uses Ceres if the library is built with it (TAXELSIM_CERES).
#pragma once

#include "characterize/weighted_solve.h"

namespace taxelsim {

// As solveWeighted(). Their results agree within the tolerances of the iterations, not in all digits.
void solveWithCeres(const GroupedProblem& problem, const RowWeights& weights, const SolveLimits& limits, ParameterValues& values);
void solveWithEigen(const GroupedProblem& problem, const RowWeights& weights, const SolveLimits& limits, ParameterValues& values);

}  // namespace taxelsim
