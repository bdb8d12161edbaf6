#include "reference/ridge_edge.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace taxelsim::reference {
namespace {

constexpr int kIterations = 2;
constexpr int kUnknowns = 6;
constexpr double kGainScatter = 0.2;    // of the weights
constexpr double kProfileError = 0.03;  // of the peak
constexpr double kPrior = 0.1;          // weight, taxels
constexpr double kLeastWeight = 1e-6;   // taxels
constexpr double kLeastWidth = 0.5;     // pitches
constexpr double kLeastAnisotropy = 1e-6;

using Vector = std::array<double, kUnknowns>;

// Solves a symmetric positive definite system by Gaussian elimination.
Vector solved(std::array<Vector, kUnknowns> matrix, Vector right) {
  for (int pivot = 0; pivot < kUnknowns; ++pivot) {
    for (int i = pivot + 1; i < kUnknowns; ++i) {
      const double factor = matrix[i][pivot] / matrix[pivot][pivot];
      for (int j = pivot; j < kUnknowns; ++j) matrix[i][j] -= factor * matrix[pivot][j];
      right[i] -= factor * right[pivot];
    }
  }
  for (int i = kUnknowns - 1; i >= 0; --i) {
    for (int j = i + 1; j < kUnknowns; ++j) right[i] -= matrix[i][j] * right[j];
    right[i] /= matrix[i][i];
  }
  return right;
}

// One round of the fit: the coefficients that follow from `before`.
Vector improved(std::span<const RidgeTaxel> taxels, std::span<const Vector> monomials, double peak, const Vector& before) {
  std::array<Vector, kUnknowns> matrix{};
  Vector right{};
  matrix[0][0] = kLeastWeight;
  for (int i = 1; i < kUnknowns; ++i) matrix[i][i] = kPrior;
  right[3] = right[5] = -0.5 * kPrior;
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    const RidgeTaxel& taxel = taxels[t];
    const bool silent = taxel.force <= 0;
    double logarithm = 0;
    for (int k = 0; k < kUnknowns; ++k) logarithm += before[k] * monomials[t][k];
    logarithm = std::clamp(logarithm, -20.0, 1.0);
    const double expected = peak * std::exp(logarithm), excess = std::clamp(taxel.force / expected - 1, -1.0, 1.0);
    const double error = std::hypot(taxel.noise, kProfileError * peak) / kGainScatter;
    double weight = expected * expected / (expected * expected + error * error);
    if (silent) weight *= std::max(1 - taxel.trigger / expected, 0.0);
    for (int i = 0; i < kUnknowns; ++i) {
      for (int j = 0; j < kUnknowns; ++j) matrix[i][j] += weight * monomials[t][i] * monomials[t][j];
      right[i] += weight * (logarithm + excess) * monomials[t][i];
    }
  }
  return solved(matrix, right);
}

}  // namespace

RidgeEdge ridgeEdge(std::span<const RidgeTaxel> taxels, const RidgeStart& start) {
  const auto [xx, xy, yy] = start.second_moments;
  const double turn = 0.5 * std::atan2(2 * xy, xx - yy), half = std::hypot((xx - yy) / 2, xy), least = kLeastWidth * start.pitch;
  const double c = std::cos(turn), s = std::sin(turn);
  const double unit_u = std::max(std::sqrt((xx + yy) / 2 + half), least);
  const double unit_v = std::max(std::sqrt(std::max((xx + yy) / 2 - half, 0.0)), least);
  std::vector<Vector> monomials;
  for (const RidgeTaxel& taxel : taxels) {
    const double x = taxel.place[0] - start.center[0], y = taxel.place[1] - start.center[1];
    const double u = (c * x + s * y) / unit_u, v = (c * y - s * x) / unit_v;
    monomials.push_back({1, u, v, u * u, u * v, v * v});
  }
  Vector fit{0, 0, 0, -0.5, 0, -0.5};  // the Gaussian with the second moments
  for (int n = 0; n < kIterations; ++n) fit = improved(taxels, monomials, start.peak, fit);
  const double uu = fit[3] / (unit_u * unit_u), uv = fit[4] / (2 * unit_u * unit_v), vv = fit[5] / (unit_v * unit_v);
  const double radius = std::hypot((uu - vv) / 2, uv), across = radius - (uu + vv) / 2, along = std::max(across - 2 * radius, 0.0);
  if (across <= 0 || radius <= kLeastAnisotropy * across) return {};
  const double angle = turn + 0.5 * std::atan2(2 * uv, uu - vv), pi = std::acos(-1.0);
  return {angle > pi / 2 ? angle - pi : angle <= -pi / 2 ? angle + pi : angle, (across - along) / (across + along)};
}

}  // namespace taxelsim::reference
