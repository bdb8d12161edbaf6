// Weighted least squares: Levenberg-Marquardt with bounds.
//
// Each iteration linearises all residuals, damps the normal equations by a multiple of their diagonal (D. W. Marquardt 1963), eliminates
// the groups' own parameters (Schur complement), and searches along the step, projected onto the bounds. A parameter at a bound whose
// gradient points outwards stays there for the iteration (active set). The damping follows the ratio of actual to predicted reduction (H.
// B. Nielsen 1999).
#include "characterize/weighted_solve.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "characterize/group_residuals.h"

namespace taxelsim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kParameterTolerance = 1e-9;  // step relative to the parameters
constexpr double kGradientTolerance = 1e-10;  // largest component of the projected gradient
constexpr double kFirstDamping = 1e-4;
constexpr double kMostDamping = 1e32;
constexpr double kLeastDiagonal = 1e-6;   // holds parameters without influence in the damped normal equations
constexpr double kLeastReduction = 1e-3;  // a step is accepted if the actual reduction is this share of the predicted one
constexpr double kLeastDecrease = 0.1;    // the line search ends where the cost falls by this share of the slope (L. Armijo 1966)
constexpr double kLeastContraction = 0.1, kMostContraction = 0.6;  // a trial shortens the step before it by a factor in this range
constexpr int kMostTrials = 20;                                    // trials of a line search

// Scaled parameters: shared, then the own ones of each group.
struct Layout {
  explicit Layout(const GroupedProblem& problem) {
    append(problem.shared);
    for (const std::vector<FitParameter>& own : problem.own) append(own);
  }

  void append(const std::vector<FitParameter>& parameters) {
    begin.push_back(static_cast<Index>(scale.size()));
    for (const FitParameter& parameter : parameters) {
      scale.push_back(parameter.scale);
      low.push_back(parameter.low / parameter.scale);
      high.push_back(parameter.high / parameter.scale);
      constant.push_back(parameter.low >= parameter.high);
    }
  }
  Index size() const { return static_cast<Index>(scale.size()); }
  Index shared() const { return begin.size() > 1 ? begin[1] : size(); }
  Index numOwn(std::size_t group) const { return (group + 2 < begin.size() ? begin[group + 2] : size()) - begin[group + 1]; }

  std::vector<double> scale, low, high;
  std::vector<bool> constant;
  std::vector<Index> begin;  // (1 + groups)
};

// Normal equations of one linearisation, block by block.
struct Normals {
  double cost = 0;
  VectorXd gradient;              // J^T r, all parameters
  MatrixXd shared;                // (shared x shared)
  std::vector<MatrixXd> own;      // (groups): (own x own)
  std::vector<MatrixXd> coupled;  // (groups): (own x shared)
};

class Solver {
 public:
  Solver(const GroupedProblem& problem, const RowWeights& weights) : problem_(problem), weights_(weights), layout_(problem) {}

  void solve(const SolveLimits& limits, ParameterValues& values) {
    VectorXd x = packed(values);
    Normals normals;
    if (linearise(x, normals)) iterate(limits, x, normals);
    unpack(x, values);
  }

 private:
  void iterate(const SolveLimits& limits, VectorXd& x, Normals& normals) const {
    double damping = kFirstDamping;
    double growth = 2;
    for (int iteration = 0; iteration < limits.max_iterations && damping < kMostDamping; ++iteration) {
      const std::vector<bool> fixed = activeSet(x, normals.gradient);
      if (projectedGradient(normals.gradient, fixed) <= kGradientTolerance) return;
      const VectorXd step = dampedStep(normals, fixed, damping);
      if ((within(x + step) - x).norm() <= kParameterTolerance * (x.norm() + kParameterTolerance)) return;
      const auto [end, cost] = search(x, step, normals);
      const double ratio = (normals.cost - cost) / predictedReduction(normals, step);
      if (!(ratio > kLeastReduction)) {
        damping *= growth;
        growth *= 2;
        continue;
      }
      x = end;
      const double before = normals.cost;
      if (!linearise(x, normals)) return;
      if (before - normals.cost <= limits.tolerance * before) return;
      const double excess = 2 * ratio - 1;
      damping *= std::max(1.0 / 3, 1 - excess * excess * excess);
      growth = 2;
    }
  }

  struct Trial {
    VectorXd x;
    double cost;
  };

  // Line search from the whole step, projected onto the bounds, towards no step: where residuals bend, the whole one may overshoot.
  Trial search(const VectorXd& x, const VectorXd& step, const Normals& normals) const {
    const double slope = normals.gradient.dot(step);
    double part = 1;
    for (int trial = 0;; ++trial) {
      VectorXd end = within(x + part * step);
      const double cost = costAt(end);
      if (cost <= normals.cost + kLeastDecrease * part * slope || trial == kMostTrials) return {std::move(end), cost};
      const double lowest = -slope * part / (2 * (cost - normals.cost - part * slope)) * part;  // of a parabola through both ends
      part = std::isfinite(lowest) ? std::clamp(lowest, kLeastContraction * part, kMostContraction * part) : kMostContraction * part;
    }
  }

  VectorXd within(VectorXd x) const {
    for (Index p = 0; p < x.size(); ++p) {
      const auto i = static_cast<std::size_t>(p);
      if (!layout_.constant[i]) x[p] = std::clamp(x[p], layout_.low[i], layout_.high[i]);
    }
    return x;
  }

  // Half the sum of squares; infinite if a residual is not finite.
  double costAt(const VectorXd& x) const {
    double cost = 0;
    for (std::size_t g = 0; g < problem_.own.size(); ++g) {
      VectorXd residuals(static_cast<Index>(problem_.num_rows[g]));
      if (!GroupResiduals(problem_, g, weights_[g]).evaluate(x.data(), ownOf(x, g), residuals.data(), nullptr, nullptr)) {
        return std::numeric_limits<double>::infinity();
      }
      cost += residuals.squaredNorm() / 2;
    }
    return cost;
  }

  bool linearise(const VectorXd& x, Normals& normals) const {
    const Index num_shared = layout_.shared();
    normals.cost = 0;
    normals.gradient.setZero(layout_.size());
    normals.shared.setZero(num_shared, num_shared);
    normals.own.resize(problem_.own.size());
    normals.coupled.resize(problem_.own.size());
    for (std::size_t g = 0; g < problem_.own.size(); ++g) {
      const auto rows = static_cast<Index>(problem_.num_rows[g]);
      VectorXd residuals(rows);
      GroupJacobians::RowMajor shared(rows, num_shared), own(rows, layout_.numOwn(g));
      if (!GroupResiduals(problem_, g, weights_[g]).evaluate(x.data(), ownOf(x, g), residuals.data(), shared.data(), own.data()))
        return false;
      normals.cost += residuals.squaredNorm() / 2;
      normals.gradient.head(num_shared) += shared.transpose() * residuals;
      normals.gradient.segment(layout_.begin[g + 1], layout_.numOwn(g)) = own.transpose() * residuals;
      normals.shared += shared.transpose() * shared;
      normals.own[g] = own.transpose() * own;
      normals.coupled[g] = own.transpose() * shared;
    }
    return true;
  }

  // Parameters that stay in this iteration: constant ones and those that the gradient presses against a bound.
  std::vector<bool> activeSet(const VectorXd& x, const VectorXd& gradient) const {
    std::vector<bool> fixed = layout_.constant;
    for (std::size_t p = 0; p < fixed.size(); ++p) {
      const auto i = static_cast<Index>(p);
      if ((x[i] <= layout_.low[p] && gradient[i] > 0) || (x[i] >= layout_.high[p] && gradient[i] < 0)) fixed[p] = true;
    }
    return fixed;
  }

  static double projectedGradient(const VectorXd& gradient, const std::vector<bool>& fixed) {
    double largest = 0;
    for (std::size_t p = 0; p < fixed.size(); ++p) {
      if (!fixed[p]) largest = std::max(largest, std::abs(gradient[static_cast<Index>(p)]));
    }
    return largest;
  }

  // Damped diagonal block for parameters from `first` on. Fixed parameters are decoupled from all others.
  static void damp(MatrixXd& block, Index first, const std::vector<bool>& fixed, double damping) {
    for (Index p = 0; p < block.rows(); ++p) {
      if (fixed[static_cast<std::size_t>(first + p)]) {
        block.row(p).setZero();
        block.col(p).setZero();
        block(p, p) = 1;
      } else {
        block(p, p) += damping * std::max(block(p, p), kLeastDiagonal);
      }
    }
  }

  VectorXd dampedStep(const Normals& normals, const std::vector<bool>& fixed, double damping) const {
    const Index num_shared = layout_.shared();
    VectorXd right = -normals.gradient;
    for (std::size_t p = 0; p < fixed.size(); ++p) {
      if (fixed[p]) right[static_cast<Index>(p)] = 0;
    }
    MatrixXd reduced = normals.shared;
    damp(reduced, 0, fixed, damping);
    VectorXd reduced_right = right.head(num_shared);
    std::vector<Eigen::LDLT<MatrixXd>> factors(problem_.own.size());
    std::vector<MatrixXd> coupled = normals.coupled;
    for (std::size_t g = 0; g < factors.size(); ++g) {
      const Index first = layout_.begin[g + 1];
      for (Index p = 0; p < coupled[g].rows(); ++p) {
        if (fixed[static_cast<std::size_t>(first + p)]) coupled[g].row(p).setZero();
      }
      for (Index p = 0; p < num_shared; ++p) {
        if (fixed[static_cast<std::size_t>(p)]) coupled[g].col(p).setZero();
      }
      if (coupled[g].rows() == 0) continue;
      MatrixXd own = normals.own[g];
      damp(own, first, fixed, damping);
      factors[g].compute(own);
      if (num_shared == 0) continue;  // Eigen does not solve for no right-hand sides
      reduced -= coupled[g].transpose() * factors[g].solve(coupled[g]);
      reduced_right -= coupled[g].transpose() * factors[g].solve(right.segment(first, own.rows()));
    }
    VectorXd step = VectorXd::Zero(layout_.size());
    if (num_shared > 0) step.head(num_shared) = reduced.ldlt().solve(reduced_right);
    for (std::size_t g = 0; g < factors.size(); ++g) {
      if (coupled[g].rows() == 0) continue;
      const Index first = layout_.begin[g + 1];
      step.segment(first, coupled[g].rows()) =
          factors[g].solve(right.segment(first, coupled[g].rows()) - coupled[g] * step.head(num_shared));
    }
    return step;
  }

  // Of the linearised cost, without bounds.
  double predictedReduction(const Normals& normals, const VectorXd& step) const {
    const VectorXd shared = step.head(layout_.shared());
    double curvature = shared.dot(normals.shared * shared);
    for (std::size_t g = 0; g < problem_.own.size(); ++g) {
      const VectorXd own = step.segment(layout_.begin[g + 1], layout_.numOwn(g));
      if (own.size() > 0) curvature += own.dot(normals.own[g] * own) + 2 * own.dot(normals.coupled[g] * shared);
    }
    return -normals.gradient.dot(step) - curvature / 2;
  }

  const double* ownOf(const VectorXd& x, std::size_t group) const { return x.data() + layout_.begin[group + 1]; }

  VectorXd packed(const ParameterValues& values) const {
    std::vector<double> all = values.shared;
    for (const std::vector<double>& own : values.own) all.insert(all.end(), own.begin(), own.end());
    VectorXd x(layout_.size());
    for (std::size_t p = 0; p < all.size(); ++p) x[static_cast<Index>(p)] = all[p] / layout_.scale[p];
    return x;
  }

  void unpack(const VectorXd& x, ParameterValues& values) const {
    std::size_t p = 0;
    const auto next = [&] {
      const double value = x[static_cast<Index>(p)] * layout_.scale[p];
      ++p;
      return value;
    };
    for (double& value : values.shared) value = next();
    for (std::vector<double>& own : values.own) {
      for (double& value : own) value = next();
    }
  }

  const GroupedProblem& problem_;
  const RowWeights& weights_;
  Layout layout_;
};

}  // namespace

void solveWeighted(const GroupedProblem& problem, const RowWeights& weights, const SolveLimits& limits, ParameterValues& values) {
  Solver(problem, weights).solve(limits, values);
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
