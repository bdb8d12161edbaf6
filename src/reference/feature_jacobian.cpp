#include "reference/feature_jacobian.h"

#include <algorithm>
#include <cmath>

#include "base/vector3.h"

namespace taxelsim::reference {

JacobianImage cleanJacobianImage(const Frame& frame) {
  return {frame.spread_force, std::vector<double>(frame.spread_force.size(), 1)};
}

JacobianImage measuredJacobianImage(const Sensor& sensor, const Frame& frame, const ReadoutDraw& draw) {
  const Readout& readout = sensor.readout;
  const double full_scale = nominalForce(readout, readout.saturation);
  JacobianImage image;
  for (std::size_t t = 0; t < frame.spread_force.size(); ++t) {
    const double gain = gainOf(readout, t) * (draw.gain.empty() ? 1 : draw.gain[t]);
    const double trigger = triggerOf(readout, t), x = gain * frame.spread_force[t] - trigger;
    const bool is_dead = !draw.dead.empty() && draw.dead[t];
    // With a trigger of 0 an unloaded taxel responds at once to a contact that is about to reach it.
    const bool responds = !is_dead && (x > 0 || trigger == 0) && x + readout.trigger < full_scale;
    image.force.push_back(!is_dead && x > 0 ? std::min(x + readout.trigger, full_scale) : 0);
    image.weight.push_back(responds ? gain : 0);
  }
  return image;
}

FeatureJacobian featureJacobian(const JacobianRow& row, const JacobianImage& image, std::span<const ByTwist> by_twist) {
  FeatureJacobian result;
  double force = 0;
  Vector3 center{0, 0, 0};
  for (std::size_t n = 0; n < row.taxels.size(); ++n) {
    force += image.force[row.taxels[n]];
    center = add(center, scale(image.force[row.taxels[n]], row.positions[n]));
  }
  result.features.total_force = force;
  if (force <= 1e-20) return result;
  center = scale(1 / force, center);
  result.features.center_of_pressure = row.X_SC * center;
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t n = 0; n < row.taxels.size(); ++n) {
    const Vector3 p = subtract(row.positions[n], center);
    const double share = image.force[row.taxels[n]] / force;
    xx += share * p[0] * p[0], xy += share * p[0] * p[1], yy += share * p[1] * p[1];
  }
  setPrincipalAxes({xx, xy, yy}, result.features);
  const auto [larger, smaller] = result.features.eigenvalues;
  result.trace = xx + yy;
  for (std::size_t k = 0; k < 6; ++k) {
    double d_force = 0, d_xx = 0, d_xy = 0, d_yy = 0;  // of the sums of F, F x^2, F x y, F y^2
    Vector3 d_first{0, 0, 0};                          // of the sum of F r
    for (std::size_t n = 0; n < row.taxels.size(); ++n) {
      const std::size_t t = row.taxels[n];
      const double rate = image.weight[t] * by_twist[t][k];
      const Vector3 p = subtract(row.positions[n], center);
      d_force += rate;
      d_first = add(d_first, scale(rate, p));
      d_xx += rate * p[0] * p[0], d_xy += rate * p[0] * p[1], d_yy += rate * p[1] * p[1];
    }
    result.total_force_by_twist[k] = d_force;
    const Vector3 d_center_S = rotate(row.X_SC.rotation, scale(1 / force, d_first));
    for (std::size_t axis = 0; axis < 3; ++axis) result.center_of_pressure[axis][k] = d_center_S[axis];
    const double difference = xx - yy, square = difference * difference + 4 * xy * xy;
    const double d_difference = (d_xx - d_yy - difference * d_force) / force, d_cross = (d_xy - xy * d_force) / force;
    if (larger - smaller > 1e-12) {
      result.edge_angle[k] = (difference * d_cross - xy * d_difference) / square;
    }
  }
  return result;
}

}  // namespace taxelsim::reference
