// Rates of taxel forces and moments under a rigid motion of the objects, for law ElasticLayer.
//
// The overlap changes at d_t = -u_z - u_x d_x - u_y d_y, u = v + w x p, with slopes from finite differences; the rates of the pressures
// then follow from the linearised contact problem (pressureRates() of elastic_layer.h). With area sampling the compliances and places of
// cells change as well (layer_cell_rates.h).
#pragma once

#include <cstddef>
#include <vector>

#include "reference/layer_cell_rates.h"
#include "reference/pressure_transport.h"

namespace taxelsim::reference {

struct LayerRates {
  std::vector<double> taxel_force;  // (num_taxels), N per unit
  Vector3 moments{0, 0, 0};         // of the integrals of p, p x and p y, margin included: N, N m, N m per unit
};

// Contact of an elastic layer with what its linearisation needs.
class LayerField {
 public:
  // `contact` must outlive this.
  LayerField(const Sensor& sensor, const LayerContact& contact);

  LayerRates rates(const Motion& motion, std::size_t num_taxels) const;

 private:
  std::size_t index(int u, int v) const { return static_cast<std::size_t>(u * layer_.nodes.num_cols + v); }
  double depthAt(int u, int v) const;
  double slope(int u, int v, int du, int dv) const;
  double pressureAt(std::size_t n) const;
  std::vector<double> nodePressureRates(const Motion& motion, const CellRates& of_cells) const;

  Layer layer_;
  const LayerContact& contact_;
  bool has_cells_;
  std::vector<Sample> samples_;
  double thickness_;
  NodeCompliance compliance_;
};

}  // namespace taxelsim::reference
