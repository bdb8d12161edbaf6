#include "sensor/flat_punch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "sensor/elastic_layer.h"

namespace taxelsim {
namespace {

struct Rule {
  std::vector<double> point, weight;
};

// Gauss-Legendre rule on [0, length]: Newton iterations on the roots of the Legendre polynomial.
Rule gaussRule(int num_points, double length) {
  constexpr int kNewtonIterations = 8;
  Rule rule;
  for (int i = 0; i < num_points; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (num_points + 0.5)), slope = 1;
    for (int k = 0; k < kNewtonIterations; ++k) {
      double previous = 1, value = x;  // P_0, P_1
      for (int n = 2; n <= num_points; ++n) {
        const double next = ((2 * n - 1) * x * value - (n - 1) * previous) / n;
        previous = value;
        value = next;
      }
      slope = num_points * (x * value - previous) / (x * x - 1);
      x -= value / slope;
    }
    rule.point.push_back((1 - x) / 2 * length);
    rule.weight.push_back(length / ((1 - x * x) * slope * slope));
  }
  return rule;
}

// Rule for the integral over y of the kernel K: panels over which y (s + t) changes by at most kTurn.
Rule kernelRule(double ratio) {
  constexpr double kEnd = 24;  // 1 - L is below 1e-14 beyond
  constexpr double kWidest = 0.5, kTurn = 16;
  const int num_panels = static_cast<int>(std::ceil(kEnd / std::min(kWidest, kTurn / (2 * ratio))));
  const double width = kEnd / num_panels;
  const Rule panel = gaussRule(16, width);
  Rule rule;
  for (int k = 0; k < num_panels; ++k) {
    for (std::size_t i = 0; i < panel.point.size(); ++i) {
      rule.point.push_back(k * width + panel.point[i]);
      rule.weight.push_back(panel.weight[i]);
    }
  }
  return rule;
}

// Solves A x = b, A symmetric and positive definite, (n x n) row-major, of which the lower triangle is read and overwritten.
std::vector<double> solveCholesky(std::vector<double> a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = j; i < n; ++i) {
      double sum = a[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i * n + k] * a[j * n + k];
      a[i * n + j] = i == j ? std::sqrt(sum) : sum / a[j * n + j];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i * n + k] * b[k];
    b[i] /= a[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k * n + i] * b[k];
    b[i] /= a[i * n + i];
  }
  return b;
}

}  // namespace

double punchFactor(double ratio, double poisson_ratio) {
  // phi varies over one thickness near the rim; four points per thickness resolve it.
  const Rule nodes = gaussRule(24 + static_cast<int>(4 * ratio), ratio), kernel = kernelRule(ratio);
  const std::size_t n = nodes.point.size();
  std::vector<double> root(n), matrix(n * n, 0), cosines(n);
  for (std::size_t i = 0; i < n; ++i) {
    root[i] = std::sqrt(nodes.weight[i]);
    matrix[i * n + i] = 1;
  }
  for (std::size_t q = 0; q < kernel.point.size(); ++q) {
    const double y = kernel.point[q];
    const double factor = 2 / std::numbers::pi * kernel.weight[q] * (layerKernel(y, poisson_ratio) - 1);
    for (std::size_t i = 0; i < n; ++i) cosines[i] = root[i] * std::cos(y * nodes.point[i]);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j <= i; ++j) matrix[i * n + j] += factor * cosines[i] * cosines[j];
    }
  }
  const std::vector<double> phi = solveCholesky(std::move(matrix), root);
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += root[i] * phi[i];
  return sum / ratio;
}

}  // namespace taxelsim
