#include "characterize/least_squares.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "characterize/covariance.h"
#include "characterize/limits.h"
#include "characterize/weighted_solve.h"

namespace taxelsim {
namespace {

// 95 % of the efficiency of plain least squares on Gaussian residuals (J. Rey, Robust Regression).
constexpr double kCauchyWidth = 2.385;  // standard deviations
constexpr SolveLimits kFirstLimits{.tolerance = 1e-5, .max_iterations = 40};
constexpr SolveLimits kReweightedLimits{.tolerance = 1e-5, .max_iterations = 5};
constexpr SolveLimits kFinalLimits{.tolerance = 1e-9, .max_iterations = 40};
constexpr int kMaxReweightings = 8;
constexpr double kConvergedDeviation = 1e-3;  // relative change of the deviation by a reweighting

std::size_t numFree(const std::vector<FitParameter>& parameters) {
  return static_cast<std::size_t>(
      std::count_if(parameters.begin(), parameters.end(), [](const FitParameter& parameter) { return parameter.low < parameter.high; }));
}

std::size_t numFree(const GroupedProblem& problem) {
  std::size_t count = numFree(problem.shared);
  for (const std::vector<FitParameter>& own : problem.own) count += numFree(own);
  return count;
}

std::vector<double> startValues(const std::vector<FitParameter>& parameters) {
  std::vector<double> values;
  for (const FitParameter& parameter : parameters) values.push_back(std::clamp(parameter.start, parameter.low, parameter.high));
  return values;
}

ParameterValues startValues(const GroupedProblem& problem) {
  ParameterValues values{startValues(problem.shared), {}};
  for (const std::vector<FitParameter>& own : problem.own) values.own.push_back(startValues(own));
  return values;
}

std::vector<std::vector<double>> residualsAt(const GroupedProblem& problem, const ParameterValues& values) {
  std::vector<std::vector<double>> residuals;
  for (std::size_t g = 0; g < problem.num_rows.size(); ++g) {
    residuals.emplace_back(problem.num_rows[g]);
    problem.residuals(g, values.shared.data(), values.own[g].data(), residuals.back().data());
  }
  return residuals;
}

// By the median absolute residual.
double robustDeviation(const std::vector<std::vector<double>>& residuals) {
  std::vector<double> sizes;
  for (const std::vector<double>& group : residuals) {
    for (const double residual : group) sizes.push_back(std::abs(residual));
  }
  return kMedianToDeviation * medianOf(std::move(sizes));
}

// Iteratively reweighted least squares with Cauchy weights. Returns the robust standard deviation of the residuals.
double fitRobustly(const GroupedProblem& problem, RowWeights& weights, ParameterValues& values, GroupedFit& fit) {
  solveWeighted(problem, weights, kFirstLimits, values);
  fit.residual = residualsAt(problem, values);
  double deviation = std::max(problem.noise, robustDeviation(fit.residual));
  for (int round = 0; round < kMaxReweightings && deviation > 0; ++round) {
    for (std::size_t g = 0; g < weights.size(); ++g) {
      for (std::size_t row = 0; row < weights[g].size(); ++row) {
        const double x = fit.residual[g][row] / (kCauchyWidth * deviation);
        weights[g][row] = 1 / std::sqrt(1 + x * x);
      }
    }
    solveWeighted(problem, weights, kReweightedLimits, values);
    fit.residual = residualsAt(problem, values);
    const double before = std::exchange(deviation, std::max(problem.noise, robustDeviation(fit.residual)));
    if (std::abs(deviation - before) <= kConvergedDeviation * before) break;
  }
  return deviation;
}

// Sets weights to 0 for outliers and to 1 for other rows.
void removeOutliers(double deviation, RowWeights& weights, GroupedFit& fit) {
  for (std::size_t g = 0; g < weights.size(); ++g) {
    fit.outlier.emplace_back(weights[g].size());
    for (std::size_t row = 0; row < weights[g].size(); ++row) {
      const bool outlier = deviation > 0 && std::abs(fit.residual[g][row]) > kOutlier * deviation;
      fit.outlier[g][row] = outlier;
      fit.num_outliers += outlier ? 1 : 0;
      weights[g][row] = outlier ? 0 : 1;
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
      // Skips infinite covariances of parameters that the gradient does not depend on.
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
    through -= own_by_shared[g].transpose() * own_gradients[g] / count;
  }
  if (through.size() > 0) variance += through.dot(covariance * through);
  return studentFactor(degrees_of_freedom) * std::sqrt(variance);
}

GroupedFit fitGroups(const GroupedProblem& problem) {
  GroupedFit fit;
  ParameterValues values = startValues(problem);
  RowWeights weights;
  for (const std::size_t num_rows : problem.num_rows) {
    weights.emplace_back(num_rows, 1.0);
    fit.num_rows += num_rows;
  }
  const double deviation = fitRobustly(problem, weights, values, fit);
  removeOutliers(deviation, weights, fit);
  solveWeighted(problem, weights, kFinalLimits, values);
  fit.residual = residualsAt(problem, values);
  double squares = 0;
  for (std::size_t g = 0; g < weights.size(); ++g) {
    for (std::size_t row = 0; row < weights[g].size(); ++row) squares += weights[g][row] * fit.residual[g][row] * fit.residual[g][row];
  }
  const std::size_t used = fit.num_rows - fit.num_outliers, num_parameters = numFree(problem);
  fit.degrees_of_freedom = used > num_parameters ? used - num_parameters : 0;
  if (fit.degrees_of_freedom > 0) fit.residual_sd = std::sqrt(squares / static_cast<double>(fit.degrees_of_freedom));
  const double known = std::max(problem.noise, fit.residual_sd);
  const double variance = fit.degrees_of_freedom > 0 ? known * known : std::numeric_limits<double>::infinity();
  setCovariances(problem, weights, values, variance, fit);
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

}  // namespace taxelsim
