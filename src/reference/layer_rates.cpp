#include "reference/layer_rates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vector3.h"
#include "reference/layer_cell_rates.h"

namespace taxelsim::reference {
namespace {

constexpr double kSteepestSlope = 2;  // depth differences at least this steep are walls of the object and give no slope

}  // namespace

LayerField::LayerField(const Sensor& sensor, const LayerContact& contact)
    : layer_(makeLayer(sensor)),
      contact_(contact),
      has_cells_(!contact.cells.share.empty()),
      samples_(layerSamples(sensor, layer_.nodes)),
      thickness_(sensor.skin.thickness) {
  if (has_cells_) compliance_ = nodeCompliance(sensor, layer_.nodes);
}

double LayerField::depthAt(int u, int v) const {
  const bool inside = u >= 0 && v >= 0 && u < layer_.nodes.num_rows && v < layer_.nodes.num_cols;
  return inside ? contact_.overlap[index(u, v)] : -std::numeric_limits<double>::infinity();
}

// Slope of d along x (du = 1) or y (dv = 1): mean of the one-sided differences that are no walls, 0 if both are. A node's depth is that of
// its place.
double LayerField::slope(int u, int v, int du, int dv) const {
  constexpr double kClosest = 0.25;  // of the spacing, between the places of two nodes
  const std::size_t axis = du == 1 ? 0 : 1;
  const double spacing = layer_.nodes.spacing[axis];
  double sum = 0, count = 0;
  for (const int side : {-1, 1}) {
    const int row = u + side * du, col = v + side * dv;
    double distance = spacing;
    if (has_cells_ && std::isfinite(depthAt(row, col))) {
      distance += side * (contact_.cells.place[index(row, col)][axis] - contact_.cells.place[index(u, v)][axis]);
    }
    const double difference = side * (depthAt(row, col) - depthAt(u, v)) / std::max(distance, kClosest * spacing);
    if (std::abs(difference) >= kSteepestSlope) continue;
    sum += difference;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

// The pressure, before relaxation, that a change of a node's compliance acts on: with the part of the dent that has the compliance of what
// is covered now. Half of it where that is as large as what made the dent, a kink.
double LayerField::pressureAt(std::size_t n) const {
  constexpr double kNear = 0.01;  // of the compliance
  const double pressure = contact_.solution.pressure[n] / contact_.gain;
  const double now = contact_.cells.compliance[n], then = contact_.dent_compliance[n];
  if (now == 0 || now * then < 0) return pressure;
  const double part = std::clamp(0.5 + (std::abs(then) / std::abs(now) - 1) / (2 * kNear), 0.0, 1.0);
  return pressure + part * (contact_.strain[n] - pressure);
}

// Rate of d - A p with p held fixed, where A changes with what is covered of the cells.
std::vector<double> LayerField::nodePressureRates(const Motion& m, const CellRates& of_cells) const {
  std::vector<double> rates(samples_.size(), 0), compliance_rates;
  const LayerCells& cells = contact_.cells;
  if (has_cells_) compliance_rates = complianceRates(layer_.nodes, compliance_, cells, of_cells);
  for (int u = 0; u < layer_.nodes.num_rows; ++u) {
    for (int v = 0; v < layer_.nodes.num_cols; ++v) {
      const std::size_t n = index(u, v);
      const double d = contact_.overlap[n];
      if (contact_.solution.pressure[n] <= 0) continue;
      if (has_cells_) rates[n] = -compliance_rates[n] * pressureAt(n);
      if (d >= thickness_) continue;
      Vector3 p = samples_[n].position_P;
      std::array<double, 2> of_place{0, 0};
      for (std::size_t axis = 0; has_cells_ && axis < 2; ++axis) {
        p[axis] += cells.place[n][axis];
        of_place[axis] = cells.edge[n] * of_cells.place[n][axis];
      }
      const Vector3 velocity = add(m.v, cross(m.w, {p[0], p[1], -d}));
      rates[n] -= velocity[2] + (velocity[0] - of_place[0]) * slope(u, v, 1, 0) + (velocity[1] - of_place[1]) * slope(u, v, 0, 1);
    }
  }
  return pressureRates(layer_, contact_, rates);
}

LayerRates LayerField::rates(const Motion& motion, std::size_t num_taxels) const {
  LayerRates rates{std::vector<double>(num_taxels, 0), {0, 0, 0}};
  CellRates of_cells;
  if (has_cells_) of_cells = cellRates(layer_.nodes, contact_.cells, contact_.overlap, motion);
  const std::vector<double> pressure_rates = nodePressureRates(motion, of_cells);
  for (std::size_t n = 0; n < pressure_rates.size(); ++n) {
    const Sample& sample = samples_[n];
    const double force = pressure_rates[n] * sample.area;
    rates.moments = add(rates.moments, scale(force, {1, sample.position_P[0], sample.position_P[1]}));
    if (has_cells_) {
      const std::array<double, 2>&place = contact_.cells.place[n], &of_place = of_cells.place[n];
      const double held = contact_.solution.pressure[n] * sample.area * contact_.cells.edge[n];
      rates.moments = add(rates.moments, {0, force * place[0] + held * of_place[0], force * place[1] + held * of_place[1]});
    }
    if (sample.taxel != kNoTaxel) rates.taxel_force[static_cast<std::size_t>(sample.taxel)] += force;
  }
  return rates;
}

}  // namespace taxelsim::reference
