#include "reference/friction.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vector3.h"
#include "reference/samples.h"

namespace taxelsim::reference {
namespace {

// Number of the object whose surface is lowest over each sample; the first of equals, as all are that lie deeper than the skin is thick.
std::vector<int> lowestObjects(const Sensor& sensor, std::span<const PlacedObject> objects, std::size_t num_samples) {
  std::vector<int> lowest(num_samples, kApart);
  std::vector<double> heights(num_samples, std::numeric_limits<double>::infinity());
  for (std::size_t number = 0; number < objects.size(); ++number) {
    const std::vector<double> own = surfaceHeights(sensor, objects.subspan(number, 1));
    for (std::size_t n = 0; n < num_samples; ++n) {
      const double height = std::max(own[n], -sensor.skin.thickness);
      if (height < heights[n]) {
        heights[n] = height;
        lowest[n] = static_cast<int>(number);
      }
    }
  }
  return lowest;
}

// (X_to X_from^-1 - 1) p in S, without the difference of nearly equal positions: (R - 1) (p - p_from) + p_to - p_from, and with
// R = 1 + 2 w [v] + 2 [v][v] for the quaternion (w, v) of the turn.
Vector3 displacementOf(const Vector3& p_S, const Pose& from, const Pose& to) {
  const auto& [fw, fx, fy, fz] = from.rotation;
  const auto [w, x, y, z] = to.rotation * Quaternion{fw, -fx, -fy, -fz};
  const Vector3 v{x, y, z}, arm = subtract(p_S, from.position), once = cross(v, arm);
  return add(scale(2, add(scale(w, once), cross(v, once))), subtract(to.position, from.position));
}

Shear onCone(const Shear& q, double cap) {
  const double size = std::hypot(q[0], q[1]);
  return size <= cap ? q : Shear{q[0] / size * cap, q[1] / size * cap};
}

}  // namespace

ContactShear contactShear(const Sensor& sensor, std::span<const PlacedObject> objects, std::span<const double> d,
                          std::span<const double> pressure, const FrictionState& before, double dt) {
  const std::vector<Sample> samples = samplesOf(sensor);
  const Friction& friction = sensor.skin.friction;
  ContactShear shear;
  shear.taxel_force.assign(samples.size() / samplesPerTaxel(sensor), {0, 0});
  const LuGre* bristles = std::get_if<LuGre>(&sensor.skin.law);
  if (friction.friction_coefficient == 0 && bristles == nullptr) return shear;
  const std::vector<int> lowest = lowestObjects(sensor, objects, samples.size());
  shear.state = {{objects.begin(), objects.end()}, std::vector<int>(samples.size(), kApart), std::vector<Shear>(samples.size(), {0, 0})};
  Vector3 force{0, 0, 0}, torque{0, 0, 0};
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (d[n] <= 0) continue;
    const int number = lowest[n];
    shear.state.touching[n] = number;
    const auto slot = static_cast<std::size_t>(number);
    const bool is_known = slot < before.objects.size() && before.objects[slot].object == objects[slot].object;
    if (!is_known) continue;
    const Sample& sample = samples[n];
    const Pose& X_SP = sensor.patches[sample.patch].X_SP;
    const Vector3 p_P{sample.position_P[0], sample.position_P[1], -d[n]}, p_S = X_SP * p_P;
    const Vector3 u = rotate(inverse(X_SP).rotation, displacementOf(p_S, before.objects[slot].X_SO, objects[slot].X_SO));
    const bool touched = before.touching[n] == number;
    const double share = !touched && u[2] < 0 ? std::min(d[n] / -u[2], 1.0) : 1.0;  // of the displacement, after touch
    const Shear held = touched ? before.held[n] : Shear{0, 0};
    Shear q = held;
    if (bristles != nullptr) {
      const Bristles after = moveBristles(*bristles, held, {u[0], u[1]}, share, dt);
      shear.state.held[n] = after.bend;
      q = {pressure[n] * after.share[0], pressure[n] * after.share[1]};
    } else {
      for (std::size_t axis = 0; axis < 2; ++axis) q[axis] += friction.tangential_stiffness * share * u[axis];
      q = onCone(q, friction.friction_coefficient * pressure[n]);
      shear.state.held[n] = q;
    }
    for (std::size_t axis = 0; axis < 2; ++axis) shear.taxel_force[sample.taxel][axis] += q[axis] * sample.area;
    const Vector3 sample_force = rotate(X_SP.rotation, {q[0] * sample.area, q[1] * sample.area, 0});
    force = add(force, sample_force);
    torque = add(torque, cross(p_S, sample_force));
  }
  shear.wrench = {force[0], force[1], force[2], torque[0], torque[1], torque[2]};
  return shear;
}

}  // namespace taxelsim::reference
