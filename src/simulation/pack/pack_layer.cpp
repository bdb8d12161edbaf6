#include "simulation/pack/pack_layer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include "shared/elastic_layer.h"
#include "taxelsim/error.h"

namespace taxelsim {

namespace {

bool fitsFloat(double force) {
  const auto rounded = static_cast<float>(force);
  return std::isnormal(rounded) && std::isfinite(rounded * 1e6f * static_cast<float>(kMaxLayerNodes));
}

}  // namespace

PackedLayer packLayer(const Sensor& sensor) {
  const auto& law = std::get<ElasticLayer>(sensor.skin.law);
  PackedLayer packed;
  packed.nodes = layerNodes(sensor);
  const LayerNodes& nodes = packed.nodes;
  packed.node_sensor = sensorOfNodes(sensor, nodes);

  const std::vector<double> influence = layerInfluence(law, sensor.skin.thickness, nodes.spacing, nodes.num_rows, nodes.num_cols);
  packed.cells = cellCompliance(law, sensor.skin.thickness, nodes.spacing);
  const double own = influence.front();
  const int strips = (nodes.num_cols + static_cast<int>(layout::kStrip) - 1) / static_cast<int>(layout::kStrip);
  const int half = strips * static_cast<int>(layout::kStrip);
  for (int u = 0; u < nodes.num_rows; ++u) {
    for (int v = -half; v < half; ++v) {
      const int distance = std::abs(v);
      const std::size_t at = static_cast<std::size_t>(u) * static_cast<std::size_t>(nodes.num_cols) + static_cast<std::size_t>(distance);
      packed.influence.push_back(distance < nodes.num_cols ? static_cast<float>(influence[at] / own) : 0.0f);
    }
  }
  // Where pressure nowhere raises the surface, contact is only where there is overlap. Else the skin bulges: a thin incompressible layer
  // rises by up to twice the depth before a round object leaves it (contact radius a^2 = 4 R delta under a sphere, 6 R delta under a
  // cylinder).
  constexpr float kReachOfBulge = 2;
  const bool bulges = std::any_of(influence.begin(), influence.end(), [&](double a) { return a < -1e-6 * own; });
  packed.reach = bulges ? kReachOfBulge : 0;
  packed.node_force = static_cast<float>(sensor.skin.thickness * nodes.area() / own);
  if (!fitsFloat(packed.node_force)) {
    throw Error(ErrorKind::kInput, "skin.elastic_modulus: forces of " + std::to_string(packed.node_force) +
                                       " N per sample at full depth are not allowed: 1e-37 to 1e27, for float32");
  }
  return packed;
}

}  // namespace taxelsim
