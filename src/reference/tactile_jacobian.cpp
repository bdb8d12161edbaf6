#include "reference/tactile_jacobian.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/vector3.h"
#include "reference/layer_rates.h"
#include "reference/pressure_transport.h"
#include "reference/psf.h"
#include "sensor/regions.h"

namespace taxelsim::reference {
namespace {

// Motion of the objects as seen from P when the sensor moves by coordinate k of its twist.
Motion seenFromPatch(const Pose& X_SP, std::size_t k) {
  Vector3 v{0, 0, 0}, w{0, 0, 0};
  (k < 3 ? v : w)[k % 3] = -1;
  const Quaternion R_PS = inverse(X_SP).rotation;
  return {rotate(R_PS, add(v, cross(w, X_SP.position))), rotate(R_PS, w)};
}

// Rates of the taxel readings from the rates of the contact forces, at rest. They differ for DeformationMask only: central difference.
std::vector<double> responseRates(const Sensor& sensor, std::span<const double> pressed, const std::vector<double>& rates) {
  if (!std::holds_alternative<DeformationMask>(sensor.skin.law)) return rates;
  // Relative to the largest force. The response is piecewise linear up to its rescaling, so the error is O(step^2).
  constexpr double kStep = 1e-5;
  double largest = 0, fastest = 0;
  for (std::size_t t = 0; t < rates.size(); ++t) {
    largest = std::max(largest, pressed[t]);
    fastest = std::max(fastest, std::abs(rates[t]));
  }
  if (largest <= 0 || fastest <= 0) return std::vector<double>(rates.size(), 0);
  const double step = kStep * largest / fastest;
  const auto responseAt = [&](double by) {
    std::vector<double> moved(pressed.begin(), pressed.end());
    for (std::size_t t = 0; t < moved.size(); ++t) moved[t] += by * rates[t];
    std::vector<TaxelState> none;
    return taxelResponse(sensor, moved, 0, none);
  };
  std::vector<double> low = responseAt(-step), high = responseAt(step);
  for (std::size_t t = 0; t < high.size(); ++t) high[t] = (high[t] - low[t]) / (2 * step);
  return high;
}

// Adds the rates of the wrench, from those of the integrals of p, p x and p y in P, to column k.
void addWrench(const Pose& X_SP, const Vector3& moment_rates, std::size_t k, std::array<ByTwist, 6>& wrench) {
  const Vector3 force_S = rotate(X_SP.rotation, {0, 0, -moment_rates[0]});
  const Vector3 torque_S = add(rotate(X_SP.rotation, {-moment_rates[2], moment_rates[1], 0}), cross(X_SP.position, force_S));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    wrench[axis][k] += force_S[axis];
    wrench[axis + 3][k] += torque_S[axis];
  }
}

// Rates of the contact forces for each coordinate of the twist, (6 x num_taxels), N. Sets the Jacobian of the wrench.
std::array<std::vector<double>, 6> contactForceRates(const Sensor& sensor, const Frame& frame, std::array<ByTwist, 6>& wrench) {
  std::array<std::vector<double>, 6> rates;
  if (std::holds_alternative<ElasticLayer>(sensor.skin.law)) {
    const LayerField field(sensor, frame.layer);
    const Pose& X_SP = sensor.patches.front().X_SP;
    for (std::size_t k = 0; k < 6; ++k) {
      const LayerRates layer_rates = field.rates(seenFromPatch(X_SP, k), frame.contact.taxel_force.size());
      rates[k] = layer_rates.taxel_force;
      addWrench(X_SP, layer_rates.moments, k, wrench);
    }
    return rates;
  }
  std::size_t first_sample = 0;
  for (const GridPatch& patch : sensor.patches) {
    const PressureField field(sensor, patch, first_sample, frame);
    first_sample += static_cast<std::size_t>(field.rows) * static_cast<std::size_t>(field.cols);
    for (std::size_t k = 0; k < 6; ++k) {
      const Motion motion = seenFromPatch(patch.X_SP, k);
      const std::vector<double> patch_rates = taxelForceRates(field, motion);
      rates[k].insert(rates[k].end(), patch_rates.begin(), patch_rates.end());
      if (std::holds_alternative<Proximity>(sensor.skin.law)) continue;  // exerts no force
      addWrench(patch.X_SP, momentRates(field, motion), k, wrench);
    }
  }
  return rates;
}

}  // namespace

TactileJacobian tactileJacobian(const Sensor& sensor, const Frame& frame, const ReadoutDraw& draw) {
  TactileJacobian result;
  const std::size_t num_taxels = frame.contact.taxel_force.size();
  result.taxel_force.resize(num_taxels);
  result.spread_force.resize(num_taxels);
  const std::array<std::vector<double>, 6> rates = contactForceRates(sensor, frame, result.contact_wrench);
  for (std::size_t k = 0; k < 6; ++k) {
    const std::vector<double> spread_rates = spread(sensor, responseRates(sensor, frame.contact.taxel_force, rates[k]));
    for (std::size_t t = 0; t < num_taxels; ++t) {
      result.taxel_force[t][k] = rates[k][t];
      result.spread_force[t][k] = spread_rates[t];
    }
  }

  const JacobianImage clean = cleanJacobianImage(frame), measured = measuredJacobianImage(sensor, frame, draw);
  const std::vector<Vector3> positions = taxelPositions(sensor);
  JacobianRow all{sensor.patches.size() == 1 ? sensor.patches.front().X_SP : Pose{}, {}, {}};
  for (std::size_t t = 0; t < num_taxels; ++t) {
    all.taxels.push_back(t);
    all.positions.push_back(inverse(all.X_SC) * positions[t]);
  }
  result.clean = featureJacobian(all, clean, result.spread_force);
  result.measured = featureJacobian(all, measured, result.spread_force);
  std::size_t first = 0;
  for (int p = 0; p < numFeaturePatches(sensor); ++p) {
    const GridPatch& patch = sensor.patches[static_cast<std::size_t>(p)];
    JacobianRow row{patch.X_SP, {}, {}};
    for (int n = 0; n < patch.num_rows * patch.num_cols; ++n, ++first) {
      row.taxels.push_back(first);
      row.positions.push_back(inverse(patch.X_SP) * positions[first]);
    }
    result.clean_patches.push_back(featureJacobian(row, clean, result.spread_force));
    result.measured_patches.push_back(featureJacobian(row, measured, result.spread_force));
  }
  return result;
}

}  // namespace taxelsim::reference
