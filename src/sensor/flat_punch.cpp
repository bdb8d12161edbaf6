#include "sensor/flat_punch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sensor/elastic_layer.h"
#include "sensor/gauss_rule.h"

namespace taxelsim {

double punchFactor(double ratio, double poisson_ratio) {
  // phi varies over one thickness near the rim; four points per thickness resolve it.
  const QuadratureRule nodes = gaussRule(ratio, 3 + static_cast<int>(ratio / 2));
  // y (s + t) changes by at most kTurn over a panel of the integral over y.
  constexpr double kWidest = 0.25, kTurn = 8;
  const QuadratureRule waves =
      gaussRule(kLayerKernelEnd, static_cast<int>(std::ceil(kLayerKernelEnd / std::min(kWidest, kTurn / (2 * ratio)))));
  // Unknowns are phi times the root of the weight, so that the matrix is symmetric.
  const Eigen::ArrayXd at = Eigen::Map<const Eigen::ArrayXd>(nodes.points.data(), static_cast<Eigen::Index>(nodes.points.size()));
  const Eigen::VectorXd root = Eigen::Map<const Eigen::ArrayXd>(nodes.weights.data(), at.size()).sqrt();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(at.size(), at.size());
  for (std::size_t q = 0; q < waves.points.size(); ++q) {
    const double y = waves.points[q];
    const double factor = 2 / std::numbers::pi * waves.weights[q] * (layerKernel(y, poisson_ratio) - 1);
    const Eigen::VectorXd cosines = root.array() * (y * at).cos();
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(cosines, factor);
  }
  return root.dot(matrix.llt().solve(root)) / ratio;
}

}  // namespace taxelsim
