// Weighted residuals of one group of a GroupedProblem and their derivatives by the scaled parameters.
#pragma once

#include <vector>

#include "characterize/least_squares.h"

namespace taxelsim {

class GroupResiduals {
 public:
  // Both must outlive this object. `weights`: (rows of the group).
  GroupResiduals(const GroupedProblem& problem, std::size_t group, const std::vector<double>& weights)
      : problem_(problem), group_(group), weights_(weights) {}

  // `shared`, `own`: scaled parameters (parameter / scale); may be null if there are none. Writes `residuals` (rows) and, unless null, the
  // row-major Jacobians (rows x shared) and (rows x own), by central differences. Returns false, with Jacobians untouched, if a residual is
  // not finite.
  bool evaluate(const double* shared, const double* own, double* residuals, double* shared_jacobian, double* own_jacobian) const;

 private:
  void differentiate(const std::vector<FitParameter>& parameters, std::vector<double>& values, const std::vector<double>& shared,
                     const std::vector<double>& own, double* jacobian) const;

  const GroupedProblem& problem_;
  std::size_t group_;
  const std::vector<double>& weights_;
};

}  // namespace taxelsim
