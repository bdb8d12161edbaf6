#include "sensor/elastic_layer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "sensor/gauss_rule.h"

namespace taxelsim {
namespace {

// Points and weights of Gauss's rule on [-1, 1].
constexpr std::array<std::array<double, 2>, 3> kGauss3{{{-0.7745966692414834, 5.0 / 9}, {0, 8.0 / 9}, {0.7745966692414834, 5.0 / 9}}};

// sinh(y) - y without cancellation.
double sinhExcess(double y) {
  if (y > 1) return std::sinh(y) - y;
  double term = y, sum = 0;
  for (int n = 2; n < 20; n += 2) {
    term *= y * y / (n * (n + 1));
    sum += term;
  }
  return sum;
}

// Love (1929): displacement times pi E* at (x, y) from the middle of a cell under 1 Pa. One term per corner, with asinh instead of
// logarithms of differences, which cancel.
double loveCorner(double x, double y) {
  return (x == 0 ? 0 : x * std::asinh(y / std::abs(x))) + (y == 0 ? 0 : y * std::asinh(x / std::abs(y)));
}

double lovePatch(double x, double y, const std::array<double, 2>& spacing) {
  const double x1 = x + spacing[0] / 2, x2 = x - spacing[0] / 2, y1 = y + spacing[1] / 2, y2 = y - spacing[1] / 2;
  return loveCorner(x1, y1) - loveCorner(x1, y2) - loveCorner(x2, y1) + loveCorner(x2, y2);
}

// Effect of the base under a point load: gamma(s) = int_0^inf (L(x) - 1) J0(x s) dx at s = r / h. L is odd, so that gamma(s) + 1/s
// decays exponentially: beyond kFar the displacement is 0.
class BaseCorrection {
 public:
  static constexpr double kFar = 25;

  explicit BaseCorrection(double poisson_ratio) {
    constexpr int kPanelsPerUnit = 8;  // over a panel x s turns by at most half a circle
    QuadratureRule rule = gaussRule(kLayerKernelEnd, static_cast<int>(kLayerKernelEnd) * kPanelsPerUnit);
    for (std::size_t q = 0; q < rule.points.size(); ++q) rule.weights[q] *= layerKernel(rule.points[q], poisson_ratio) - 1;
    for (int k = 0; k < static_cast<int>(kFar * kPerUnit) + kTaps; ++k) {
      double sum = 0;
      for (std::size_t q = 0; q < rule.points.size(); ++q) sum += rule.weights[q] * ::j0(rule.points[q] * k / kPerUnit);
      table_.push_back(sum);
    }
  }

  double operator()(double s) const {
    if (s >= kFar) return -1 / s;
    // Lagrange's polynomial through the eight nearest entries; gamma is even.
    const double at = s * kPerUnit;
    const int first = static_cast<int>(at) - kTaps / 2 + 1;
    double sum = 0;
    for (int k = 0; k < kTaps; ++k) {
      double weight = table_[static_cast<std::size_t>(std::abs(first + k))];
      for (int m = 0; m < kTaps; ++m) {
        if (m != k) weight *= (at - first - m) / (k - m);
      }
      sum += weight;
    }
    return sum;
  }

 private:
  static constexpr int kPerUnit = 16;
  static constexpr int kTaps = 8;
  std::vector<double> table_;
};

// Integral of gamma(r / h) / h over a cell: 3 x 3 points in each part, parts no wider than half a thickness.
double correctionOverCell(const BaseCorrection& gamma, double thickness, double x, double y, const std::array<double, 2>& spacing) {
  std::array<int, 2> parts{};
  for (std::size_t axis = 0; axis < 2; ++axis) parts[axis] = std::max(1, static_cast<int>(std::ceil(2 * spacing[axis] / thickness)));
  const double width = spacing[0] / parts[0], height = spacing[1] / parts[1];
  double sum = 0;
  for (int i = 0; i < parts[0]; ++i) {
    for (int j = 0; j < parts[1]; ++j) {
      for (const auto& [u, weight_u] : kGauss3) {
        for (const auto& [v, weight_v] : kGauss3) {
          const double dx = x - spacing[0] / 2 + (i + (1 + u) / 2) * width, dy = y - spacing[1] / 2 + (j + (1 + v) / 2) * height;
          sum += weight_u * weight_v * gamma(std::hypot(dx, dy) / thickness);
        }
      }
    }
  }
  return sum * width * height / 4 / thickness;
}

}  // namespace

LayerNodes layerNodes(const Sensor& sensor) {
  const GridPatch& patch = sensor.patches.front();
  LayerNodes nodes;
  for (std::size_t axis = 0; axis < 2; ++axis) nodes.spacing[axis] = patch.pitch[axis] / sensor.samples_per_taxel;
  nodes.margin_rows = static_cast<int>(std::lround(sensor.skin.margin / nodes.spacing[0]));
  nodes.margin_cols = static_cast<int>(std::lround(sensor.skin.margin / nodes.spacing[1]));
  nodes.num_rows = patch.num_rows * sensor.samples_per_taxel + 2 * nodes.margin_rows;
  nodes.num_cols = patch.num_cols * sensor.samples_per_taxel + 2 * nodes.margin_cols;
  return nodes;
}

Sensor sensorOfNodes(const Sensor& sensor, const LayerNodes& nodes) {
  Sensor result = sensor;
  GridPatch& grid = result.patches.front();
  grid.num_rows = nodes.num_rows;
  grid.num_cols = nodes.num_cols;
  grid.pitch = nodes.spacing;
  result.samples_per_taxel = 1;
  result.psf = Psf{};
  result.readout = Readout{};
  return result;
}

double planeModulus(double elastic_modulus, double poisson_ratio) {
  return elastic_modulus / (1 - poisson_ratio * poisson_ratio);
}

double layerKernel(double x, double poisson_ratio) {
  const double c = 3 - 4 * poisson_ratio;
  // Divided by exp(2 x) where that would overflow.
  if (x > 20) {
    const double e = std::exp(-2 * x);
    return (c * (1 - e * e) - 4 * x * e) / (c * (1 + e * e) + (4 * x * x + 1 + c * c) * e);
  }
  return (2 * c * sinhExcess(2 * x) + 4 * (c - 1) * x) / (2 * c * std::cosh(2 * x) + 4 * x * x + 1 + c * c);
}

CellCompliance cellCompliance(const ElasticLayer& layer, double thickness, const std::array<double, 2>& spacing) {
  const double area = spacing[0] * spacing[1], free = lovePatch(0, 0, spacing) / std::numbers::pi;  // times E*
  CellCompliance compliance{.disc = std::sqrt(std::numbers::pi * area) / 2, .free = free, .point = area / std::numbers::pi};
  double own = free;
  if (layer.base == ElasticLayer::Base::kBonded) {
    const BaseCorrection gamma(layer.poisson_ratio);
    const double of_cell = correctionOverCell(gamma, thickness, 0, 0, spacing) / std::numbers::pi;
    compliance.base = gamma(0) / thickness * area / std::numbers::pi - of_cell;
    compliance.image_depth = -thickness / gamma(0);
    own += of_cell;
  }
  for (double* value : {&compliance.disc, &compliance.free, &compliance.base, &compliance.point}) *value /= own;
  return compliance;
}

std::vector<double> layerInfluence(const ElasticLayer& layer, double thickness, const std::array<double, 2>& spacing, int num_rows,
                                   int num_cols) {
  const double plane_modulus = planeModulus(layer.elastic_modulus, layer.poisson_ratio);
  const bool bonded = layer.base == ElasticLayer::Base::kBonded;
  const BaseCorrection gamma(layer.poisson_ratio);
  std::vector<double> influence;
  influence.reserve(static_cast<std::size_t>(num_rows) * static_cast<std::size_t>(num_cols));
  for (int u = 0; u < num_rows; ++u) {
    for (int v = 0; v < num_cols; ++v) {
      const double x = u * spacing[0], y = v * spacing[1];
      const double nearest = std::hypot(std::max(0.0, x - spacing[0] / 2), std::max(0.0, y - spacing[1] / 2));
      double sum = 0;
      if (!bonded || nearest < BaseCorrection::kFar * thickness) sum = lovePatch(x, y, spacing);
      if (bonded && nearest < BaseCorrection::kFar * thickness) sum += correctionOverCell(gamma, thickness, x, y, spacing);
      influence.push_back(sum / (std::numbers::pi * plane_modulus));
    }
  }
  return influence;
}

}  // namespace taxelsim
