#include "reference/layer_rates.h"

#include <cmath>
#include <limits>

#include "base/vector3.h"

namespace taxelsim::reference {
namespace {

constexpr double kSteepestSlope = 2;  // depth differences at least this steep are walls of the object and give no slope

}  // namespace

LayerField::LayerField(const Sensor& sensor, const LayerContact& contact)
    : layer_(makeLayer(sensor)), contact_(contact), samples_(layerSamples(sensor, layer_.nodes)), thickness_(sensor.skin.thickness) {}

double LayerField::depthAt(int u, int v) const {
  const bool inside = u >= 0 && v >= 0 && u < layer_.nodes.num_rows && v < layer_.nodes.num_cols;
  return inside ? contact_.overlap[index(u, v)] : -std::numeric_limits<double>::infinity();
}

// Slope of d along x (du = 1) or y (dv = 1): mean of the one-sided differences that are no walls, 0 if both are.
double LayerField::slope(int u, int v, int du, int dv) const {
  const double spacing = layer_.nodes.spacing[du == 1 ? 0 : 1];
  double sum = 0, count = 0;
  for (const int side : {-1, 1}) {
    const double difference = side * (depthAt(u + side * du, v + side * dv) - depthAt(u, v)) / spacing;
    if (std::abs(difference) >= kSteepestSlope) continue;
    sum += difference;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

std::vector<double> LayerField::nodePressureRates(const Motion& m) const {
  std::vector<double> overlap_rates(samples_.size(), 0);
  for (int u = 0; u < layer_.nodes.num_rows; ++u) {
    for (int v = 0; v < layer_.nodes.num_cols; ++v) {
      const std::size_t n = index(u, v);
      const double d = contact_.overlap[n];
      if (contact_.solution.pressure[n] <= 0 || d >= thickness_) continue;
      const Vector3& p = samples_[n].position_P;
      const Vector3 velocity = add(m.v, cross(m.w, {p[0], p[1], -d}));
      overlap_rates[n] = -velocity[2] - velocity[0] * slope(u, v, 1, 0) - velocity[1] * slope(u, v, 0, 1);
    }
  }
  return pressureRates(layer_, contact_, overlap_rates);
}

LayerRates LayerField::rates(const Motion& motion, std::size_t num_taxels) const {
  LayerRates rates{std::vector<double>(num_taxels, 0), {0, 0, 0}};
  const std::vector<double> pressure_rates = nodePressureRates(motion);
  for (std::size_t n = 0; n < pressure_rates.size(); ++n) {
    const Sample& sample = samples_[n];
    const double force = pressure_rates[n] * sample.area;
    rates.moments = add(rates.moments, scale(force, {1, sample.position_P[0], sample.position_P[1]}));
    if (sample.taxel != kNoTaxel) rates.taxel_force[static_cast<std::size_t>(sample.taxel)] += force;
  }
  return rates;
}

}  // namespace taxelsim::reference
