#include "reference/features.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/readout.h"

namespace taxelsim::reference {
namespace {

std::vector<TaxelPlace> placesOf(const Sensor& sensor) {
  std::vector<TaxelPlace> places;
  for (const GridPatch& patch : sensor.patches) {
    for (int i = 0; i < patch.num_rows; ++i) {
      for (int j = 0; j < patch.num_cols; ++j) {
        const double x = (i - (patch.num_rows - 1) / 2.0) * patch.pitch[0];
        const double y = (j - (patch.num_cols - 1) / 2.0) * patch.pitch[1];
        const Vector3 p_S = patch.X_SP * Vector3{x, y, 0};
        const bool single_patch = sensor.patches.size() == 1;
        places.push_back({p_S, {single_patch ? x : p_S[0], single_patch ? y : p_S[1]}, patch.pitch[0] * patch.pitch[1]});
      }
    }
  }
  return places;
}

}  // namespace

void setPrincipalAxes(const std::array<double, 3>& second_moments, Features& features) {
  const auto [xx, xy, yy] = second_moments;
  const double middle = (xx + yy) / 2, radius = std::hypot((xx - yy) / 2, xy);
  features.second_moments = second_moments;
  features.eigenvalues = {middle + radius, std::max(0.0, middle - radius)};
  const auto [larger, smaller] = features.eigenvalues;
  if (radius > 0) {
    features.edge_angle = std::atan2(2 * xy, xx - yy) / 2;
    if (features.edge_angle <= -std::numbers::pi / 2) {
      features.edge_angle += std::numbers::pi;  // atan2 returns -pi for a negative zero
    }
    features.edge_confidence = (larger - smaller) / (larger + smaller);
  }
}

Features featuresOf(std::span<const TaxelPlace> places, std::span<const double> force, const std::vector<bool>& is_touched) {
  Features features;
  std::array<double, 2> mean{0, 0};
  for (std::size_t t = 0; t < force.size(); ++t) {
    features.total_force += force[t];
    features.peak_force = std::max(features.peak_force, force[t]);
    features.contact_area += is_touched[t] ? places[t].area : 0;
    for (int axis = 0; axis < 3; ++axis) {
      features.center_of_pressure[axis] += force[t] * places[t].position_S[axis];
    }
    mean[0] += force[t] * places[t].in_plane[0];
    mean[1] += force[t] * places[t].in_plane[1];
  }
  if (features.total_force <= 0) {
    features.center_of_pressure = {0, 0, 0};
    return features;
  }
  for (double& coordinate : features.center_of_pressure) {
    coordinate /= features.total_force;
  }
  mean = {mean[0] / features.total_force, mean[1] / features.total_force};

  std::array<double, 3> second_moments{0, 0, 0};
  auto& [xx, xy, yy] = second_moments;
  for (std::size_t t = 0; t < force.size(); ++t) {
    const double x = places[t].in_plane[0] - mean[0], y = places[t].in_plane[1] - mean[1];
    const double weight = force[t] / features.total_force;
    xx += weight * x * x;
    xy += weight * x * y;
    yy += weight * y * y;
  }
  setPrincipalAxes(second_moments, features);
  return features;
}

Features featuresOf(const Sensor& sensor, std::span<const double> force, const std::vector<bool>& is_touched) {
  return featuresOf(placesOf(sensor), force, is_touched);
}

Features cleanFeatures(const Sensor& sensor, std::span<const double> spread_force) {
  std::vector<bool> is_touched;
  for (std::size_t t = 0; t < spread_force.size(); ++t) {
    is_touched.push_back(spread_force[t] > std::max(0.0, triggerOf(sensor.readout, t)));
  }
  return featuresOf(sensor, spread_force, is_touched);
}

Features measuredFeatures(const Sensor& sensor, std::span<const std::uint32_t> counts) {
  std::vector<bool> is_touched;
  for (const std::uint32_t value : counts) {
    is_touched.push_back(value > 0);
  }
  return featuresOf(sensor, measuredForce(sensor, counts), is_touched);
}

}  // namespace taxelsim::reference
