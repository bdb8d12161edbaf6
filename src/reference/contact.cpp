#include "reference/contact.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/vector3.h"
#include "reference/samples.h"

namespace taxelsim::reference {

namespace {

// Pressure at penetration d > 0, one overload per law.
struct Pressure {
  double d, rate;

  double operator()(const Winkler& law) const {
    return std::max(0.0, law.normal_contact_stiffness * std::pow(d, law.normal_exponent) + law.normal_damping * rate);
  }
  double operator()(const MassSpringDamper& law) const { return law.normal_contact_stiffness * d; }
  double operator()(const DeformationMask& law) const { return law.normal_contact_stiffness * d; }
  double operator()(const Proximity& law) const { return law.sensitivity * d; }
  double operator()(const ElasticLayer&) const { throw std::logic_error("elastic_layer has no pressure per sample"); }
  double operator()(const LuGre& law) const { return law.normal_contact_stiffness * d; }
};

}  // namespace

double contactPressure(const ContactLaw& law, double d, double rate) {
  return d <= 0 ? 0 : std::visit(Pressure{d, rate}, law);
}

namespace {

// `pressureAt(n, rate)`: pressure of sample n, whose depth grows by `rate` (m/s), before relaxation.
template <typename PressureAt>
Contact contactOf(const Sensor& sensor, std::span<const double> d, std::span<const double> previous, double dt, const SkinStep& skin,
                  PressureAt pressureAt) {
  const std::vector<Sample> samples = samplesOf(sensor);
  Contact contact;
  contact.taxel_force.assign(samples.size() / samplesPerTaxel(sensor), 0);
  contact.mean_penetration.assign(contact.taxel_force.size(), 0);
  std::size_t num_over = 0;
  Vector3 force{0, 0, 0}, torque{0, 0, 0};
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const Sample& sample = samples[n];
    const double rate = previous.empty() || dt == 0 ? 0 : (d[n] - previous[n]) / dt;
    const auto [pressure, strain] = skin.press(n, pressureAt(n, rate));
    contact.pressure.push_back(pressure);
    contact.strain.push_back(strain);
    contact.taxel_force[sample.taxel] += pressure * sample.area;
    contact.mean_penetration[sample.taxel] += std::max(d[n], 0.0) / static_cast<double>(samplesPerTaxel(sensor));
    num_over += d[n] >= sensor.skin.thickness ? 1 : 0;
    const Pose& X_SP = sensor.patches[sample.patch].X_SP;
    const Vector3 sample_force = rotate(X_SP.rotation, {0, 0, -pressure * sample.area});
    force = add(force, sample_force);
    torque = add(torque, cross(X_SP * sample.position_P, sample_force));
  }
  for (const double taxel_force : contact.taxel_force) {
    contact.total_force += taxel_force;
  }
  if (std::holds_alternative<Proximity>(sensor.skin.law)) force = torque = {0, 0, 0};  // exerts no force
  contact.wrench = {force[0], force[1], force[2], torque[0], torque[1], torque[2]};
  contact.over_penetration = static_cast<double>(num_over) / static_cast<double>(samples.size());
  return contact;
}

}  // namespace

Contact computeContact(const Sensor& sensor, std::span<const double> d, std::span<const double> previous, double dt, const SkinStep& skin) {
  return contactOf(sensor, d, previous, dt, skin, [&](std::size_t n, double rate) { return contactPressure(sensor.skin.law, d[n], rate); });
}

Contact computeContact(const Sensor& sensor, const AreaDepths& depths, std::span<const double> previous, double dt, const SkinStep& skin) {
  if (foundationOf(sensor.skin).normal_exponent == 1) return computeContact(sensor, depths.mean, previous, dt, skin);
  return contactOf(sensor, depths.mean, previous, dt, skin, [&](std::size_t n, double rate) {
    double pressure = 0;
    for (const CellPoint& point : depths.points[n]) {
      pressure += depths.share[n] * point.weight * contactPressure(sensor.skin.law, point.depth, rate / depths.share[n]);
    }
    return pressure;
  });
}

}  // namespace taxelsim::reference
