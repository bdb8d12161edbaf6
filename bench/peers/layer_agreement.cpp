#include "peers/layer_agreement.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <variant>

namespace taxelsim::bench {
namespace {

// Least eigenvalue of a circulant matrix that holds A: of the even table of twice the rows and columns, its cosine transform. No eigenvalue
// of A, which is a principal submatrix, is smaller (Cauchy's interlacing).
double leastEigenvalue(const Sensor& sensor, const LayerNodes& nodes) {
  const int last_row = nodes.num_rows, last_col = nodes.num_cols;
  const std::vector<double> table =
      layerInfluence(std::get<ElasticLayer>(sensor.skin.law), sensor.skin.thickness, nodes.spacing, last_row + 1, last_col + 1);
  // Weight of entry n in the transform at k: entries other than the first and the last appear twice.
  const auto weight = [](int k, int n, int last) { return (n == 0 || n == last ? 1 : 2) * std::cos(std::numbers::pi * k * n / last); };
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> over_rows;
  for (int i = 0; i <= last_row; ++i) {
    over_rows.assign(static_cast<std::size_t>(last_col + 1), 0);
    std::size_t from = 0;
    for (int u = 0; u <= last_row; ++u) {
      for (double& sum : over_rows) sum += weight(i, u, last_row) * table[from++];
    }
    for (int j = 0; j <= last_col; ++j) {
      double sum = 0;
      for (int v = 0; v <= last_col; ++v) sum += weight(j, v, last_col) * over_rows[static_cast<std::size_t>(v)];
      least = std::min(least, sum);
    }
  }
  return least;
}

}  // namespace

std::vector<double> layerOverlaps(const Sensor& sensor, const Object& object, const Pose& X_SO) {
  const std::vector<reference::PlacedObject> placed{{&object, X_SO}};
  std::vector<double> overlaps = reference::layerHeights(sensor, layerNodes(sensor), placed);
  for (double& d : overlaps) d = std::min(-d, sensor.skin.thickness);
  return overlaps;
}

std::vector<double> layerForces(const Sensor& sensor, std::span<const double> overlaps, std::span<const double> pressures) {
  reference::LayerContact contact;
  contact.overlap.assign(overlaps.begin(), overlaps.end());
  contact.solution.pressure.assign(pressures.begin(), pressures.end());
  reference::sumForces(sensor, layerNodes(sensor), contact);
  return contact.taxel_force;
}

LayerAgreement::LayerAgreement(const Sensor& sensor)
    : sensor_(sensor),
      layer_(reference::makeLayer(sensor)),
      least_eigenvalue_(leastEigenvalue(sensor, layer_.nodes)),
      bulges_(*std::min_element(layer_.influence.begin(), layer_.influence.end()) < 0) {}

double LayerAgreement::residual(std::span<const double> overlaps, std::span<const double> pressures) const {
  const int cols = layer_.nodes.num_cols, size = layer_.nodes.num_rows * cols;
  const double deepest = *std::max_element(overlaps.begin(), overlaps.end());
  if (deepest <= 0) return 0;
  std::vector<int> sources;
  for (int m = 0; m < size; ++m) {
    if (pressures[static_cast<std::size_t>(m)] != 0) sources.push_back(m);
  }
  double squares = 0, number = 0;
  for (int n = 0; n < size; ++n) {
    double r = -overlaps[static_cast<std::size_t>(n)];
    for (const int m : sources) {
      const int distance = std::abs(n / cols - m / cols) * cols + std::abs(n % cols - m % cols);
      r += layer_.influence[static_cast<std::size_t>(distance)] * pressures[static_cast<std::size_t>(m)];
    }
    const double p = pressures[static_cast<std::size_t>(n)];
    if (p < 0) return std::numeric_limits<double>::infinity();
    number += p > 0 ? 1 : 0;
    squares += p > 0 ? r * r : std::min(r, 0.0) * std::min(r, 0.0);
  }
  return std::sqrt(squares / std::max(number, 1.0)) / deepest;
}

std::vector<double> LayerAgreement::solution(std::span<const double> overlaps) const {
  return reference::solveLayer(layer_, overlaps).pressure;
}

double LayerAgreement::forceBound(std::span<const double> overlaps, double tolerance, double depth_error) const {
  constexpr double kReachOfBulge = 2;  // as on the device
  const double deepest = std::max(*std::max_element(overlaps.begin(), overlaps.end()), 0.0);
  const double limit = bulges_ ? -kReachOfBulge * deepest : 0;
  const auto touched = static_cast<double>(std::count_if(overlaps.begin(), overlaps.end(), [&](double d) { return d > limit; }));
  const double per_pressure = layer_.nodes.area() * sensor_.samples_per_taxel;  // |sums of s^2 values| <= s |values|
  return per_pressure * (tolerance * deepest + depth_error) * std::sqrt(touched) / least_eigenvalue_;
}

}  // namespace taxelsim::bench
