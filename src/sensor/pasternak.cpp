#include "sensor/pasternak.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace taxelsim {

double decayLength(const Pasternak& law) {
  return std::sqrt(law.shear_stiffness / law.normal_contact_stiffness);
}

int pasternakRefinement(const Sensor& sensor) {
  constexpr double kNodesPerDecay = 3, kCellsPerDecay = 2.25;
  double pitch = 0;
  for (const GridPatch& patch : sensor.patches) pitch = std::max({pitch, patch.pitch[0], patch.pitch[1]});
  const double spacing = pitch / sensor.samples_per_taxel;
  const double per_decay = sensor.depth_sampling == DepthSampling::kArea ? kCellsPerDecay : kNodesPerDecay;
  const double parts = std::ceil(per_decay * spacing / decayLength(std::get<Pasternak>(sensor.skin.law)));
  return static_cast<int>(std::clamp(parts, 1.0, kMaxRefinement + 1.0));
}

LayerNodes pasternakNodes(const Sensor& sensor) {
  Sensor refined = sensor;
  refined.samples_per_taxel *= pasternakRefinement(sensor);
  return layerNodes(refined);
}

LayerNodes finestPasternakNodes(const Sensor& sensor) {
  const auto area = [](const GridPatch& patch) { return patch.pitch[0] * patch.pitch[1]; };
  Sensor finest = sensor;
  finest.patches = {*std::min_element(sensor.patches.begin(), sensor.patches.end(),
                                      [&](const GridPatch& a, const GridPatch& b) { return area(a) < area(b); })};
  finest.samples_per_taxel *= pasternakRefinement(sensor);
  return layerNodes(finest);
}

double pasternakReach(const LayerNodes& nodes) {
  return 2 * std::max(nodes.spacing[0], nodes.spacing[1]);
}

double largestPasternakPressure(const Sensor& sensor) {
  const auto& law = std::get<Pasternak>(sensor.skin.law);
  const LayerNodes nodes = finestPasternakNodes(sensor);
  const double over_seams = sensor.patches.size() > 1 ? 2 : 1;  // where patches overlap, nodes are nearer to each other than in a grid
  const auto links = [&](double spacing) { return 4 * over_seams * law.shear_stiffness / (spacing * spacing); };
  return sensor.skin.thickness * (law.normal_contact_stiffness + links(nodes.spacing[0]) + links(nodes.spacing[1]));
}

double sweepRelaxation(const Pasternak& law, const LayerNodes& nodes) {
  const auto [x, y] = nodes.spacing;
  const double springs = law.normal_contact_stiffness * x * y, links = 2 * law.shear_stiffness * (y / x + x / y);
  const double jacobi = links / (springs + links);  // spectral radius of Jacobi's method (D. M. Young, 1954)
  return 2 / (1 + std::sqrt(1 - jacobi * jacobi));
}

int pasternakSweeps(const Sensor& sensor) {
  constexpr double kReduction = 0.4;
  const auto& law = std::get<Pasternak>(sensor.skin.law);
  if (law.iterations > 0) return law.iterations;
  const double rate = sweepRelaxation(law, finestPasternakNodes(sensor)) - 1;
  int sweeps = 1;
  while (sweeps < kMaxLayerIterations && (sweeps < 1 / -std::log(rate) || sweeps * std::pow(rate, sweeps) > kReduction)) ++sweeps;
  return sweeps;
}

double besselRatio(double x) {
  // Beyond, K0 underflows; the asymptotic series is right to 1e-6.
  constexpr double kFar = 100;
  if (x > kFar) return 1 + 1 / (2 * x) - 1 / (8 * x * x);
  return std::cyl_bessel_k(1, x) / std::cyl_bessel_k(0, x);
}

double pasternakPunchStiffness(const Pasternak& law, double radius) {
  const double x = radius / decayLength(law);
  return std::numbers::pi * radius * radius * law.normal_contact_stiffness * (1 + 2 / x * besselRatio(x));
}

}  // namespace taxelsim
