// Weighted least squares by Ceres.
#include <ceres/ceres.h>

#include "characterize/group_residuals.h"
#include "characterize/solvers.h"

namespace taxelsim {
namespace {

// Residuals of one group. Parameter blocks: shared, then own; empty blocks are left out.
class GroupCost final : public ceres::CostFunction {
 public:
  GroupCost(const GroupedProblem& problem, std::size_t group, const std::vector<double>& weights)
      : residuals_(problem, group, weights), has_shared_(!problem.shared.empty()), has_own_(!problem.own[group].empty()) {
    set_num_residuals(static_cast<int>(weights.size()));
    if (has_shared_) mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.shared.size()));
    if (has_own_) mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.own[group].size()));
  }

  bool Evaluate(double const* const* scaled, double* residuals, double** jacobians) const override {
    const std::size_t own = has_shared_ ? 1 : 0;
    return residuals_.evaluate(has_shared_ ? scaled[0] : nullptr, has_own_ ? scaled[own] : nullptr, residuals,
                               has_shared_ && jacobians != nullptr ? jacobians[0] : nullptr,
                               has_own_ && jacobians != nullptr ? jacobians[own] : nullptr);
  }

 private:
  GroupResiduals residuals_;
  bool has_shared_;
  bool has_own_;
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

void solveWithCeres(const GroupedProblem& problem, const RowWeights& weights, const SolveLimits& limits, ParameterValues& values) {
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

}  // namespace taxelsim
