#include "sensor/deformation_mask.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/vector3.h"
#include "sensor/gauss_rule.h"

namespace taxelsim {
namespace {

// RobWorkSim's TactileArraySensor: max(0, kFloor + kPeak / (1 + r^2)), r = kScale times the distance in taxels.
constexpr double kFloor = -0.34766355, kPeak = 1.22429907, kScale = 4.0 / 3;

double maskAt(double distance_in_taxels) {
  const double r = kScale * distance_in_taxels;
  return std::max(0.0, kFloor + kPeak / (1 + r * r));
}

// Distance at which the mask ends, taxels.
const double kReach = std::sqrt(-kPeak / kFloor - 1) / kScale;

struct Taxel {
  Vector3 position, normal, x, y;  // in S; x and y along the sides
  double length, width;            // m

  double size() const { return std::sqrt(length * width); }
};

std::vector<Taxel> taxelsOf(const Sensor& sensor) {
  std::vector<Taxel> taxels;
  for (const GridPatch& patch : sensor.patches) {
    const Quaternion& R_SP = patch.X_SP.rotation;
    taxels.push_back(
        {patch.X_SP.position, rotate(R_SP, {0, 0, 1}), rotate(R_SP, {1, 0, 0}), rotate(R_SP, {0, 1, 0}), patch.pitch[0], patch.pitch[1]});
  }
  return taxels;
}

// Integral of the mask of `source` over the rectangle of `target`, in taxels^2.
double integral(const Taxel& source, const Taxel& target) {
  if (dot(source.normal, target.normal) <= 0) return 0;
  const double size = (source.size() + target.size()) / 2;
  if (length(subtract(target.position, source.position)) > kReach * size + std::hypot(target.length, target.width) / 2) return 0;
  constexpr int kPanels = 4;  // the mask has a kink where it ends
  const QuadratureRule rule = gaussRule(1, kPanels);
  double sum = 0;
  for (std::size_t i = 0; i < rule.points.size(); ++i) {
    const Vector3 row = add(target.position, scale((rule.points[i] - 0.5) * target.length, target.x));
    for (std::size_t j = 0; j < rule.points.size(); ++j) {
      const Vector3 point = add(row, scale((rule.points[j] - 0.5) * target.width, target.y));
      const double distance = skinDistance(source.position, source.normal, point, target.normal);
      sum += rule.weights[i] * rule.weights[j] * maskAt(distance / size);
    }
  }
  return sum * target.length * target.width / (size * size);
}

}  // namespace

std::vector<std::vector<MaskSource>> maskSources(const Sensor& sensor) {
  const std::vector<Taxel> taxels = taxelsOf(sensor);
  double reach = 0;
  for (const Taxel& taxel : taxels) reach = std::max(reach, std::hypot(taxel.length, taxel.width));
  reach *= kReach + 0.5;
  // No chord is longer than its arc, so neighbours are near along x.
  std::vector<std::size_t> by_x(taxels.size());
  std::iota(by_x.begin(), by_x.end(), std::size_t{0});
  std::stable_sort(by_x.begin(), by_x.end(), [&](std::size_t a, std::size_t b) { return taxels[a].position[0] < taxels[b].position[0]; });
  std::vector<std::vector<MaskSource>> targets(taxels.size());  // of each source
  for (std::size_t a = 0; a < by_x.size(); ++a) {
    for (std::size_t b = a; b < by_x.size() && taxels[by_x[b]].position[0] - taxels[by_x[a]].position[0] <= reach; ++b) {
      const auto add_pair = [&](std::size_t source, std::size_t target) {
        const double weight = integral(taxels[source], taxels[target]);
        if (weight > 0) targets[source].push_back({static_cast<int>(target), weight});
      };
      add_pair(by_x[a], by_x[b]);
      if (a != b) add_pair(by_x[b], by_x[a]);
    }
  }
  std::vector<std::vector<MaskSource>> sources(taxels.size());
  for (std::size_t source = 0; source < targets.size(); ++source) {
    double total = 0;
    for (const MaskSource& target : targets[source]) total += target.weight;
    for (const MaskSource& target : targets[source]) {
      sources[static_cast<std::size_t>(target.taxel)].push_back({static_cast<int>(source), target.weight / total});
    }
  }
  return sources;
}

}  // namespace taxelsim
