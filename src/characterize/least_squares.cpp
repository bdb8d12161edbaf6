#include "characterize/least_squares.h"

#include <ceres/ceres.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace taxelsim {
namespace {

// 95 % as good as plain least squares where there are no outliers (J. Rey, Robust Regression).
constexpr double kCauchyWidth = 2.385;           // standard deviations
constexpr double kOutlier = 4.5;                 // standard deviations: one in 150,000 of a Gaussian's
constexpr double kMedianToDeviation = 1.482602;  // standard deviation / median of |x|, of a Gaussian
constexpr int kMaxIterations = 40;
constexpr int kMaxIterationsPerRound = 5;    // while the weights still change
constexpr double kTolerance = 1e-9;          // of the sum of squares, of the last fit
constexpr double kTolerancePerRound = 1e-5;  // the same, while the weights still change
constexpr int kMaxReweightings = 8;
constexpr double kSettled = 1e-3;  // of the deviation from one reweighting to the next
constexpr double kDerivativeStep = 1e-6;
constexpr double kLeastEigenvalue = 1e-11;
constexpr double kTold = 1e-6;  // share (squared) of a parameter in directions that the rows do not tell, below which it is told

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Weights = std::vector<std::vector<double>>;

// Values of both kinds, or of one: in units of the parameters' scales, or not.
struct Values {
  std::vector<double> shared;
  std::vector<std::vector<double>> own;
};

// The rows of one group. Parameter blocks: shared, own, each only where there are any.
class Group final : public ceres::CostFunction {
 public:
  Group(const GroupedProblem& problem, std::size_t group, const std::vector<double>& weights)
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

  // `values` is one of `shared` and `own`. Central differences, towards the inside where a bound is near.
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

void solve(const GroupedProblem& problem, const Weights& weights, double tolerance, int max_iterations, Values& values) {
  // One array for all: Ceres orders blocks by their addresses, which must not depend on what else the heap holds.
  std::size_t count = problem.shared.size();
  for (const std::vector<FitParameter>& own : problem.own) count += own.size();
  std::vector<double> scaled(count);
  double* next = scaled.data();
  ceres::Problem ceres_problem;
  auto* const ordering = new ceres::ParameterBlockOrdering;
  const auto add = [&](const std::vector<double>& block, const std::vector<FitParameter>& parameters, int elimination_group) {
    double* const at = std::exchange(next, next + block.size());
    if (block.empty()) return at;
    for (std::size_t p = 0; p < block.size(); ++p) at[p] = block[p] / parameters[p].scale;
    ceres_problem.AddParameterBlock(at, static_cast<int>(block.size()));
    std::vector<int> fixed;
    for (std::size_t p = 0; p < block.size(); ++p) {
      const int number = static_cast<int>(p);
      if (parameters[p].low >= parameters[p].high) {
        fixed.push_back(number);
        continue;
      }
      ceres_problem.SetParameterLowerBound(at, number, parameters[p].low / parameters[p].scale);
      ceres_problem.SetParameterUpperBound(at, number, parameters[p].high / parameters[p].scale);
    }
    if (!fixed.empty()) ceres_problem.SetManifold(at, new ceres::SubsetManifold(static_cast<int>(block.size()), fixed));
    ordering->AddElementToGroup(at, elimination_group);
    return at;
  };
  double* const shared = add(values.shared, problem.shared, 1);
  bool any_own = false;
  for (std::size_t g = 0; g < problem.own.size(); ++g) {
    double* const own = add(values.own[g], problem.own[g], 0);
    any_own = any_own || !problem.own[g].empty();
    std::vector<double*> blocks;
    if (!values.shared.empty()) blocks.push_back(shared);
    if (!values.own[g].empty()) blocks.push_back(own);
    if (!blocks.empty() && problem.num_rows[g] > 0) ceres_problem.AddResidualBlock(new Group(problem, g, weights[g]), nullptr, blocks);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = any_own && !values.shared.empty() ? ceres::DENSE_SCHUR : ceres::DENSE_QR;
  options.linear_solver_ordering.reset(ordering);
  options.max_num_iterations = max_iterations;
  options.function_tolerance = tolerance;
  options.parameter_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  const double* from = scaled.data();
  for (std::size_t p = 0; p < values.shared.size(); ++p) values.shared[p] = *from++ * problem.shared[p].scale;
  for (std::size_t g = 0; g < values.own.size(); ++g) {
    for (std::size_t p = 0; p < values.own[g].size(); ++p) values.own[g][p] = *from++ * problem.own[g][p].scale;
  }
}

std::size_t numFree(const std::vector<FitParameter>& parameters) {
  return static_cast<std::size_t>(
      std::count_if(parameters.begin(), parameters.end(), [](const FitParameter& parameter) { return parameter.low < parameter.high; }));
}

std::vector<std::vector<double>> residualsAt(const GroupedProblem& problem, const Values& values) {
  std::vector<std::vector<double>> residuals;
  for (std::size_t g = 0; g < problem.num_rows.size(); ++g) {
    residuals.emplace_back(problem.num_rows[g]);
    problem.residuals(g, values.shared.data(), values.own[g].data(), residuals.back().data());
  }
  return residuals;
}

// Standard deviation as the median sees it.
double robustDeviation(const std::vector<std::vector<double>>& residuals) {
  std::vector<double> sizes;
  for (const std::vector<double>& group : residuals) {
    for (const double residual : group) sizes.push_back(std::abs(residual));
  }
  return kMedianToDeviation * medianOf(std::move(sizes));
}

// Inverse of a symmetric matrix, in the directions in which it is told; `told` says which parameters have no part in the others.
Eigen::MatrixXd inverseWhereTold(const Eigen::MatrixXd& normal, const Eigen::VectorXd& lengths, std::vector<bool>& told) {
  const Eigen::Index count = normal.rows();
  told.assign(static_cast<std::size_t>(count), true);
  if (count == 0) return normal;
  Eigen::VectorXd inverse_length(count);
  for (Eigen::Index p = 0; p < count; ++p) inverse_length[p] = lengths[p] > 0 ? 1 / lengths[p] : 0;
  const Eigen::MatrixXd unit = inverse_length.asDiagonal() * normal * inverse_length.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(unit);
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::VectorXd direction = eigen.eigenvectors().col(k);
    if (eigen.eigenvalues()[k] >= kLeastEigenvalue) {
      inverse += direction * direction.transpose() / eigen.eigenvalues()[k];
      continue;
    }
    for (Eigen::Index p = 0; p < count; ++p) {
      if (direction[p] * direction[p] > kTold) told[static_cast<std::size_t>(p)] = false;
    }
  }
  return inverse_length.asDiagonal() * inverse * inverse_length.asDiagonal();
}

Eigen::VectorXd scalesOf(const std::vector<FitParameter>& parameters) {
  Eigen::VectorXd scales(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t p = 0; p < parameters.size(); ++p) scales[static_cast<Eigen::Index>(p)] = parameters[p].scale;
  return scales;
}

// Covariances by the normal matrix in its arrow form, the groups' own parameters eliminated: with J = [A B] of a group,
//   S = sum A^T A - A^T B (B^T B)^-1 B^T A,  own covariance = (B^T B)^-1 + W^T S^-1 W,  W = A^T B (B^T B)^-1.
void setCovariances(const GroupedProblem& problem, const Weights& weights, const Values& values, double variance, GroupedFit& fit) {
  const auto num_shared = static_cast<Eigen::Index>(problem.shared.size());
  Eigen::MatrixXd schur = Eigen::MatrixXd::Zero(num_shared, num_shared);
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(num_shared);
  std::vector<Eigen::MatrixXd> own_inverse, gain, by_row;
  std::vector<std::vector<bool>> own_told;
  for (std::size_t g = 0; g < problem.own.size(); ++g) {
    const auto rows = static_cast<Eigen::Index>(problem.num_rows[g]), num_own = static_cast<Eigen::Index>(problem.own[g].size());
    RowMajor a(rows, num_shared), b(rows, num_own);
    a.setZero(), b.setZero();
    std::vector<double> shared, own, residuals(problem.num_rows[g]);
    for (std::size_t p = 0; p < problem.shared.size(); ++p) shared.push_back(values.shared[p] / problem.shared[p].scale);
    for (std::size_t p = 0; p < problem.own[g].size(); ++p) own.push_back(values.own[g][p] / problem.own[g][p].scale);
    std::vector<const double*> blocks;
    std::vector<double*> jacobians;
    if (!shared.empty()) blocks.push_back(shared.data()), jacobians.push_back(a.data());
    if (!own.empty()) blocks.push_back(own.data()), jacobians.push_back(b.data());
    Group(problem, g, weights[g]).Evaluate(blocks.data(), residuals.data(), jacobians.data());
    const Eigen::MatrixXd normal = b.transpose() * b, mixed = a.transpose() * b;
    std::vector<bool> told;
    own_inverse.push_back(inverseWhereTold(normal, b.colwise().norm().transpose(), told));
    own_told.push_back(std::move(told));
    gain.emplace_back(mixed * own_inverse.back());
    const Eigen::Map<const Eigen::VectorXd> weight(weights[g].data(), rows);
    by_row.emplace_back((a.transpose() - gain.back() * b.transpose()) * weight.asDiagonal());
    squares += a.colwise().squaredNorm().transpose();
    schur += a.transpose() * a - gain.back() * mixed.transpose();
  }
  std::vector<bool> told;
  fit.covariance = inverseWhereTold(schur, squares.cwiseSqrt(), told);
  for (const Eigen::MatrixXd& rows : by_row) fit.response.emplace_back(scalesOf(problem.shared).asDiagonal() * (fit.covariance * rows));
  for (std::size_t g = 0; g < problem.own.size(); ++g) {
    const Eigen::MatrixXd own = own_inverse[g] + gain[g].transpose() * fit.covariance * gain[g];
    std::vector<double> variances;
    for (std::size_t p = 0; p < problem.own[g].size(); ++p) {
      const auto at = static_cast<Eigen::Index>(p);
      const double scale = problem.own[g][p].scale;
      variances.push_back(own_told[g][p] ? variance * scale * scale * own(at, at) : kInfinity);
    }
    fit.own_variance.push_back(std::move(variances));
    const Eigen::VectorXd own_scale = scalesOf(problem.own[g]);
    fit.own_covariance.emplace_back(variance * (own_scale.asDiagonal() * own_inverse[g] * own_scale.asDiagonal()));
    fit.lean.emplace_back(own_scale.asDiagonal() * gain[g].transpose() * scalesOf(problem.shared).cwiseInverse().asDiagonal());
  }
  for (Eigen::Index p = 0; p < num_shared; ++p) {
    for (Eigen::Index q = 0; q < num_shared; ++q) {
      const auto i = static_cast<std::size_t>(p), j = static_cast<std::size_t>(q);
      const double scale = problem.shared[i].scale * problem.shared[j].scale;
      fit.covariance(p, q) = told[i] && told[j] ? variance * scale * fit.covariance(p, q) : kInfinity;
    }
  }
}

}  // namespace

double GroupedFit::halfWidth(std::size_t shared_parameter) const {
  const auto p = static_cast<Eigen::Index>(shared_parameter);
  return studentFactor(degrees_of_freedom) * std::sqrt(covariance(p, p));
}

double GroupedFit::halfWidthOf(const Eigen::VectorXd& gradient) const {
  double variance = 0;
  for (Eigen::Index p = 0; p < gradient.size(); ++p) {
    for (Eigen::Index q = 0; q < gradient.size(); ++q) {
      // What the rows do not tell is infinite, and need not matter here.
      if (gradient[p] != 0 && gradient[q] != 0) variance += gradient[p] * covariance(p, q) * gradient[q];
    }
  }
  return studentFactor(degrees_of_freedom) * std::sqrt(std::max(0.0, variance));
}

double GroupedFit::ownHalfWidth(std::size_t group, std::size_t parameter) const {
  return studentFactor(degrees_of_freedom) * std::sqrt(own_variance[group][parameter]);
}

double GroupedFit::meanHalfWidth(const std::vector<Eigen::VectorXd>& own_gradients, const Eigen::VectorXd& shared_gradient) const {
  const auto count = static_cast<double>(own_gradients.size());
  double variance = 0;
  Eigen::VectorXd through = shared_gradient;
  for (std::size_t g = 0; g < own_gradients.size(); ++g) {
    variance += own_gradients[g].dot(own_covariance[g] * own_gradients[g]) / (count * count);
    through -= lean[g].transpose() * own_gradients[g] / count;
  }
  if (through.size() > 0) variance += through.dot(covariance * through);
  return studentFactor(degrees_of_freedom) * std::sqrt(variance);
}

GroupedFit fitGroups(const GroupedProblem& problem) {
  GroupedFit fit;
  Values values;
  Weights weights;
  std::size_t num_parameters = numFree(problem.shared);
  for (const FitParameter& parameter : problem.shared) values.shared.push_back(std::clamp(parameter.start, parameter.low, parameter.high));
  for (std::size_t g = 0; g < problem.own.size(); ++g) {
    values.own.emplace_back();
    for (const FitParameter& parameter : problem.own[g]) {
      values.own.back().push_back(std::clamp(parameter.start, parameter.low, parameter.high));
    }
    weights.emplace_back(problem.num_rows[g], 1.0);
    num_parameters += numFree(problem.own[g]);
    fit.num_rows += problem.num_rows[g];
  }
  solve(problem, weights, kTolerancePerRound, kMaxIterations, values);
  fit.residual = residualsAt(problem, values);
  double deviation = std::max(problem.noise, robustDeviation(fit.residual));
  for (int round = 0; round < kMaxReweightings && deviation > 0; ++round) {
    for (std::size_t g = 0; g < weights.size(); ++g) {
      for (std::size_t row = 0; row < weights[g].size(); ++row) {
        const double x = fit.residual[g][row] / (kCauchyWidth * deviation);
        weights[g][row] = 1 / std::sqrt(1 + x * x);
      }
    }
    solve(problem, weights, kTolerancePerRound, kMaxIterationsPerRound, values);
    fit.residual = residualsAt(problem, values);
    const double before = std::exchange(deviation, std::max(problem.noise, robustDeviation(fit.residual)));
    if (std::abs(deviation - before) <= kSettled * before) break;
  }
  for (std::size_t g = 0; g < weights.size(); ++g) {
    fit.outlier.emplace_back(weights[g].size());
    for (std::size_t row = 0; row < weights[g].size(); ++row) {
      const bool outlier = deviation > 0 && std::abs(fit.residual[g][row]) > kOutlier * deviation;
      fit.outlier[g][row] = outlier;
      fit.num_outliers += outlier ? 1 : 0;
      weights[g][row] = outlier ? 0 : 1;
    }
  }
  solve(problem, weights, kTolerance, kMaxIterations, values);
  fit.residual = residualsAt(problem, values);
  double squares = 0;
  for (std::size_t g = 0; g < weights.size(); ++g) {
    for (std::size_t row = 0; row < weights[g].size(); ++row) squares += weights[g][row] * fit.residual[g][row] * fit.residual[g][row];
  }
  const std::size_t used = fit.num_rows - fit.num_outliers;
  fit.degrees_of_freedom = used > num_parameters ? used - num_parameters : 0;
  if (fit.degrees_of_freedom > 0) fit.residual_sd = std::sqrt(squares / static_cast<double>(fit.degrees_of_freedom));
  const double known = std::max(problem.noise, fit.residual_sd);
  setCovariances(problem, weights, values, fit.degrees_of_freedom > 0 ? known * known : kInfinity, fit);
  fit.shared = std::move(values.shared);
  fit.own = std::move(values.own);
  return fit;
}

double cutSquares(const GroupedFit& fit, double deviation) {
  const double most = 9 * deviation * deviation;
  double squares = 0;
  for (const std::vector<double>& group : fit.residual) {
    for (const double residual : group) squares += std::min(most, residual * residual);
  }
  return squares;
}

bool isBetterFit(double squares, double squares_with_more, double more, double freedom, double chance) {
  if (!(freedom > 0) || !(squares > squares_with_more)) return false;
  if (!(squares_with_more > 0)) return true;
  // F as a Gaussian: M. Abramowitz and I. Stegun, Handbook of Mathematical Functions, 26.6.15.
  const double root = std::cbrt((squares - squares_with_more) / more / (squares_with_more / freedom));
  const double a = 2 / (9 * freedom), b = 2 / (9 * more);
  return ((1 - a) * root - (1 - b)) / std::sqrt(a * root * root + b) > chance;
}

double FitResult::halfWidth(std::size_t parameter) const {
  const auto p = static_cast<Eigen::Index>(parameter);
  return studentFactor(degrees_of_freedom) * std::sqrt(covariance(p, p));
}

FitResult fitRows(std::size_t num_rows, const std::vector<FitParameter>& parameters,
                  const std::function<double(std::size_t, const double*)>& residual) {
  GroupedProblem problem{.shared = parameters, .own = {{}}, .num_rows = {num_rows}, .residuals = {}};
  problem.residuals = [&](std::size_t, const double* shared, const double*, double* residuals) {
    for (std::size_t row = 0; row < num_rows; ++row) residuals[row] = residual(row, shared);
  };
  GroupedFit fit = fitGroups(problem);
  return {.values = std::move(fit.shared),
          .covariance = std::move(fit.covariance),
          .residual_sd = fit.residual_sd,
          .outlier = std::move(fit.outlier.front()),
          .num_outliers = fit.num_outliers,
          .degrees_of_freedom = fit.degrees_of_freedom};
}

double studentFactor(std::size_t degrees_of_freedom) {
  constexpr double kNormal = 1.959963985;
  if (degrees_of_freedom == 0) return std::numeric_limits<double>::infinity();
  if (degrees_of_freedom == 1) return 12.7062;
  if (degrees_of_freedom == 2) return 4.3027;
  const double n = static_cast<double>(degrees_of_freedom), x = kNormal, x2 = x * x;
  return x + x * (x2 + 1) / (4 * n) + x * ((5 * x2 + 16) * x2 + 3) / (96 * n * n) +
         x * (((3 * x2 + 19) * x2 + 17) * x2 - 15) / (384 * n * n * n);
}

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

}  // namespace taxelsim
