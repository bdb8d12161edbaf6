#include "characterize/weighted_solve.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace taxelsim {
namespace {

constexpr double kDerivativeStep = 1e-6;  // of a parameter's scale

// Residuals of one group. Parameter blocks: shared, then own; empty blocks are left out.
class GroupCost final : public ceres::CostFunction {
 public:
  GroupCost(const GroupedProblem& problem, std::size_t group, const std::vector<double>& weights)
      : problem_(problem), group_(group), weights_(weights) {
    set_num_residuals(static_cast<int>(weights.size()));
    if (!problem.shared.empty()) mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.shared.size()));
    if (!problem.own[group].empty()) mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.own[group].size()));
  }

  bool Evaluate(double const* const* scaled, double* residuals, double** jacobians) const override {
    const std::vector<FitParameter>&shared_parameters = problem_.shared, &own_parameters = problem_.own[group_];
    const double* const scaled_shared = shared_parameters.empty() ? nullptr : scaled[0];
    const std::size_t own_block = shared_parameters.empty() ? 0 : 1;
    const double* const scaled_own = own_parameters.empty() ? nullptr : scaled[own_block];
    std::vector<double> shared = unscaled(scaled_shared, shared_parameters), own = unscaled(scaled_own, own_parameters);
    problem_.residuals(group_, shared.data(), own.data(), residuals);
    for (std::size_t row = 0; row < weights_.size(); ++row) {
      residuals[row] *= weights_[row];
      if (!std::isfinite(residuals[row])) return false;
    }
    if (jacobians == nullptr) return true;
    if (scaled_shared != nullptr && jacobians[0] != nullptr) differentiate(shared_parameters, shared, shared, own, jacobians[0]);
    if (scaled_own != nullptr && jacobians[own_block] != nullptr) differentiate(own_parameters, own, shared, own, jacobians[own_block]);
    return true;
  }

 private:
  static std::vector<double> unscaled(const double* scaled, const std::vector<FitParameter>& parameters) {
    std::vector<double> values(parameters.size());
    for (std::size_t p = 0; p < values.size(); ++p) values[p] = scaled[p] * parameters[p].scale;
    return values;
  }

  // Central differences by `values`, which is `shared` or `own`; one-sided at a bound.
  void differentiate(const std::vector<FitParameter>& parameters, std::vector<double>& values, const std::vector<double>& shared,
                     const std::vector<double>& own, double* jacobian) const {
    const std::size_t count = parameters.size();
    std::vector<double> high(weights_.size()), low(weights_.size());
    for (std::size_t p = 0; p < count; ++p) {
      const double value = values[p], step = kDerivativeStep * parameters[p].scale;
      const double below = std::max(value - step, parameters[p].low), above = std::min(value + step, parameters[p].high);
      values[p] = above;
      problem_.residuals(group_, shared.data(), own.data(), high.data());
      values[p] = below;
      problem_.residuals(group_, shared.data(), own.data(), low.data());
      values[p] = value;
      const double width = (above - below) / parameters[p].scale;
      for (std::size_t row = 0; row < weights_.size(); ++row) {
        jacobian[row * count + p] = width > 0 ? weights_[row] * (high[row] - low[row]) / width : 0;
      }
    }
  }

  const GroupedProblem& problem_;
  std::size_t group_;
  const std::vector<double>& weights_;
};
// Scaled parameter values in one array, because Ceres orders blocks by their addresses: with separate allocations the order, and so the
// last digits of the result, would depend on the heap.
class ScaledBlocks {
 public:
  ScaledBlocks(const GroupedProblem& problem, const ParameterValues& values) : problem_(problem) {
    append(values.shared, problem.shared);
    for (std::size_t g = 0; g < problem.own.size(); ++g) append(values.own[g], problem.own[g]);
  }

  double* shared() { return scaled_.data(); }
  double* own(std::size_t group) { return scaled_.data() + begin_[group + 1]; }

  void read(ParameterValues& values) const {
    read(0, problem_.shared, values.shared);
    for (std::size_t g = 0; g < problem_.own.size(); ++g) read(g + 1, problem_.own[g], values.own[g]);
  }

 private:
  void append(const std::vector<double>& values, const std::vector<FitParameter>& parameters) {
    begin_.push_back(scaled_.size());
    for (std::size_t p = 0; p < values.size(); ++p) scaled_.push_back(values[p] / parameters[p].scale);
  }
  void read(std::size_t block, const std::vector<FitParameter>& parameters, std::vector<double>& values) const {
    for (std::size_t p = 0; p < values.size(); ++p) values[p] = scaled_[begin_[block] + p] * parameters[p].scale;
  }

  const GroupedProblem& problem_;
  std::vector<double> scaled_;
  std::vector<std::size_t> begin_;  // (1 + groups)
};

// Bounds and constant parameters.
void addBlock(double* scaled, const std::vector<FitParameter>& parameters, ceres::Problem& problem) {
  const int count = static_cast<int>(parameters.size());
  problem.AddParameterBlock(scaled, count);
  std::vector<int> constant;
  for (int p = 0; p < count; ++p) {
    const FitParameter& parameter = parameters[static_cast<std::size_t>(p)];
    if (parameter.low >= parameter.high) {
      constant.push_back(p);
      continue;
    }
    problem.SetParameterLowerBound(scaled, p, parameter.low / parameter.scale);
    problem.SetParameterUpperBound(scaled, p, parameter.high / parameter.scale);
  }
  if (!constant.empty()) problem.SetManifold(scaled, new ceres::SubsetManifold(count, constant));
}

}  // namespace

void solveWeighted(const GroupedProblem& problem, const RowWeights& weights, const SolveLimits& limits, ParameterValues& values) {
  ScaledBlocks blocks(problem, values);
  ceres::Problem ceres_problem;
  auto* const ordering = new ceres::ParameterBlockOrdering;  // Ceres takes ownership
  constexpr int kEliminatedFirst = 0, kEliminatedLast = 1;
  if (!problem.shared.empty()) {
    addBlock(blocks.shared(), problem.shared, ceres_problem);
    ordering->AddElementToGroup(blocks.shared(), kEliminatedLast);
  }
  bool any_own = false;
  for (std::size_t g = 0; g < problem.own.size(); ++g) {
    std::vector<double*> used;
    if (!problem.shared.empty()) used.push_back(blocks.shared());
    if (!problem.own[g].empty()) {
      any_own = true;
      addBlock(blocks.own(g), problem.own[g], ceres_problem);
      ordering->AddElementToGroup(blocks.own(g), kEliminatedFirst);
      used.push_back(blocks.own(g));
    }
    if (!used.empty() && problem.num_rows[g] > 0) ceres_problem.AddResidualBlock(new GroupCost(problem, g, weights[g]), nullptr, used);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = any_own && !problem.shared.empty() ? ceres::DENSE_SCHUR : ceres::DENSE_QR;
  options.linear_solver_ordering.reset(ordering);
  options.max_num_iterations = limits.max_iterations;
  options.function_tolerance = limits.tolerance;
  options.parameter_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  blocks.read(values);
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
  std::vector<const double*> blocks;
  std::vector<double*> jacobians;
  if (!shared.empty()) blocks.push_back(shared.data()), jacobians.push_back(result.shared.data());
  if (!own.empty()) blocks.push_back(own.data()), jacobians.push_back(result.own.data());
  GroupCost(problem, group, weights).Evaluate(blocks.data(), residuals.data(), jacobians.data());
  return result;
}

}  // namespace taxelsim
