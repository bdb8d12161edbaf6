// Covariances of a GroupedFit by the normal matrix.
#pragma once

#include "characterize/least_squares.h"
#include "characterize/weighted_solve.h"

namespace taxelsim {

// Fills covariance, own_variance, own_covariance, own_by_shared and response of `fit`. `variance` is that of a row's residual.
//
// The normal matrix has arrow form. With the Jacobian J = [A B] of a group,
//   S = sum A^T A - A^T B (B^T B)^-1 B^T A is the inverse covariance of the shared values,
//   (B^T B)^-1 + W^T S^-1 W with W = A^T B (B^T B)^-1 the covariance of the group's own values.
void setCovariances(const GroupedProblem& problem, const RowWeights& weights, const ParameterValues& values, double variance,
                    GroupedFit& fit);

}  // namespace taxelsim
