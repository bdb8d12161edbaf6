#include "characterize/group_residuals.h"

#include <algorithm>
#include <cmath>

namespace taxelsim {
namespace {

constexpr double kDerivativeStep = 1e-6;  // of a parameter's scale

std::vector<double> unscaled(const double* scaled, const std::vector<FitParameter>& parameters) {
  std::vector<double> values(parameters.size());
  for (std::size_t p = 0; p < values.size(); ++p) values[p] = scaled[p] * parameters[p].scale;
  return values;
}

}  // namespace

bool GroupResiduals::evaluate(const double* shared_scaled, const double* own_scaled, double* residuals, double* shared_jacobian,
                              double* own_jacobian) const {
  const std::vector<FitParameter>&shared_parameters = problem_.shared, &own_parameters = problem_.own[group_];
  std::vector<double> shared = unscaled(shared_scaled, shared_parameters), own = unscaled(own_scaled, own_parameters);
  problem_.residuals(group_, shared.data(), own.data(), residuals);
  for (std::size_t row = 0; row < weights_.size(); ++row) {
    residuals[row] *= weights_[row];
    if (!std::isfinite(residuals[row])) return false;
  }
  if (shared_jacobian != nullptr) differentiate(shared_parameters, shared, shared, own, shared_jacobian);
  if (own_jacobian != nullptr) differentiate(own_parameters, own, shared, own, own_jacobian);
  return true;
}

// Central differences by `values`, which is `shared` or `own`; one-sided at a bound.
void GroupResiduals::differentiate(const std::vector<FitParameter>& parameters, std::vector<double>& values,
                                   const std::vector<double>& shared, const std::vector<double>& own, double* jacobian) const {
  const std::size_t count = parameters.size();
  std::vector<double> high(weights_.size()), low(weights_.size());
  for (std::size_t p = 0; p < count; ++p) {
    if (!(parameters[p].low < parameters[p].high)) {
      for (std::size_t row = 0; row < weights_.size(); ++row) jacobian[row * count + p] = 0;
      continue;
    }
    const double value = values[p], step = kDerivativeStep * parameters[p].scale;
    const double below = std::max(value - step, parameters[p].low), above = std::min(value + step, parameters[p].high);
    values[p] = above;
    problem_.residuals(group_, shared.data(), own.data(), high.data());
    values[p] = below;
    problem_.residuals(group_, shared.data(), own.data(), low.data());
    values[p] = value;
    const double width = (above - below) / parameters[p].scale;
    for (std::size_t row = 0; row < weights_.size(); ++row) {
      jacobian[row * count + p] = weights_[row] * (high[row] - low[row]) / width;
    }
  }
}

}  // namespace taxelsim
