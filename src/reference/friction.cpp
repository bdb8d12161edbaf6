#include "reference/friction.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vector3.h"
#include "reference/contact.h"
#include "reference/samples.h"

namespace taxelsim::reference {
namespace {

// Displacement (X_to X_from^-1 - 1) p_S of the material point at p_S. Without cancellation: (R - 1) (p - p_from) + p_to - p_from, with
// R - 1 = 2 w [v] + 2 [v][v] for the quaternion (w, v) of the relative rotation and [v] the cross-product matrix.
Vector3 rigidDisplacement(const Vector3& p_S, const Pose& from, const Pose& to) {
  const auto& [fw, fx, fy, fz] = from.rotation;
  const auto [w, x, y, z] = to.rotation * Quaternion{fw, -fx, -fy, -fz};
  const Vector3 v{x, y, z}, arm = subtract(p_S, from.position), v_cross_arm = cross(v, arm);
  return add(scale(2, add(scale(w, v_cross_arm), cross(v, v_cross_arm))), subtract(to.position, from.position));
}

// Return mapping: q scaled back to the rim of Coulomb's cone.
Shear returnToCone(const Shear& q, double cap) {
  const double size = std::hypot(q[0], q[1]);
  return size <= cap ? q : Shear{q[0] / size * cap, q[1] / size * cap};
}

// Two points for each cell, which share its pressure as they would at rest.
PressedSkin pressedPoints(const Sensor& sensor, const AreaDepths& cells, std::span<const double> pressure) {
  PressedSkin skin;
  const std::vector<Sample> samples = samplesOf(sensor);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const CellPoints& points = cells.points[n];
    const auto atRest = [&](const CellPoint& point) { return point.weight * contactPressure(sensor.skin.law, point.depth, 0); };
    const double sum = atRest(points[0]) + atRest(points[1]);
    for (const CellPoint& point : points) {
      Sample sample = samples[n];
      for (std::size_t axis = 0; axis < 2; ++axis) sample.position_P[axis] += point.from_middle[axis];
      skin.points.push_back(sample);
      skin.touching.push_back(cells.touching[n]);
      skin.d.push_back(point.depth);
      skin.pressure.push_back(sum > 0 ? pressure[n] * atRest(point) / sum : 0);
      skin.share.push_back(cells.share[n] * point.weight);
    }
  }
  return skin;
}

}  // namespace

std::vector<int> lowestObjects(std::span<const PlacedObject> objects, double thickness,
                               const std::function<std::vector<double>(std::span<const PlacedObject>)>& heightsUnder) {
  std::vector<int> lowest;
  std::vector<double> heights;
  for (std::size_t number = 0; number < objects.size(); ++number) {
    const std::vector<double> object_heights = heightsUnder(objects.subspan(number, 1));
    lowest.resize(object_heights.size(), kNoContact);
    heights.resize(object_heights.size(), std::numeric_limits<double>::infinity());
    for (std::size_t n = 0; n < object_heights.size(); ++n) {
      const double height = std::max(object_heights[n], -thickness);
      if (height < heights[n]) {
        heights[n] = height;
        lowest[n] = static_cast<int>(number);
      }
    }
  }
  return lowest;
}

PressedSkin pressedSamples(const Sensor& sensor, std::span<const PlacedObject> objects, const AreaDepths& cells, std::span<const double> d,
                           std::span<const double> pressure) {
  const auto heightsUnder = [&](std::span<const PlacedObject> object) { return surfaceHeights(sensor, object); };
  PressedSkin skin{samplesOf(sensor), std::vector<int>(d.size(), kNoContact), {d.begin(), d.end()}, {pressure.begin(), pressure.end()}};
  if (!hasFriction(sensor.skin) || objects.empty()) return skin;
  if (sensor.depth_sampling == DepthSampling::kArea) return pressedPoints(sensor, cells, pressure);
  const std::vector<int> lowest = lowestObjects(objects, sensor.skin.thickness, heightsUnder);
  for (std::size_t n = 0; n < d.size(); ++n) skin.touching[n] = d[n] > 0 ? lowest[n] : kNoContact;
  return skin;
}

ContactShear contactShear(const Sensor& sensor, std::span<const PlacedObject> objects, const PressedSkin& skin, const FrictionState& before,
                          double dt) {
  const Friction& friction = sensor.skin.friction;
  ContactShear shear;
  shear.taxel_force.assign(static_cast<std::size_t>(numTaxels(sensor)), {0, 0});
  if (!hasFriction(sensor.skin)) return shear;
  const LuGre* bristles = std::get_if<LuGre>(&sensor.skin.law);
  shear.state = {{objects.begin(), objects.end()}, skin.touching, std::vector<Shear>(skin.points.size(), {0, 0})};
  Vector3 force{0, 0, 0}, torque{0, 0, 0};
  for (std::size_t n = 0; n < skin.points.size(); ++n) {
    const int number = skin.touching[n];
    if (number == kNoContact) continue;
    const auto slot = static_cast<std::size_t>(number);
    const bool is_known = slot < before.objects.size() && before.objects[slot].object == objects[slot].object;
    if (!is_known) continue;
    const Sample& point = skin.points[n];
    const double d = skin.d[n], pressure = skin.pressure[n], share = skin.share.empty() ? 1 : skin.share[n];
    const Pose& X_SP = sensor.patches[static_cast<std::size_t>(point.patch)].X_SP;
    const Vector3 p_P{point.position_P[0], point.position_P[1], -d}, p_S = X_SP * p_P;
    const Vector3 u = rotate(inverse(X_SP).rotation, rigidDisplacement(p_S, before.objects[slot].X_SO, objects[slot].X_SO));
    const bool touched = before.touching[n] == number;
    const double after_touch = !touched && u[2] < 0 ? std::clamp(d / -u[2], 0.0, 1.0) : 1.0;  // fraction of the displacement
    const Shear history = touched ? before.history[n] : Shear{0, 0};
    Shear q = history;
    if (bristles != nullptr) {
      const Bristles after = updateBristles(*bristles, history, {u[0], u[1]}, after_touch, dt);
      shear.state.history[n] = after.deflection;
      q = {pressure * after.traction_ratio[0], pressure * after.traction_ratio[1]};
    } else {
      for (std::size_t axis = 0; axis < 2; ++axis) q[axis] += friction.tangential_stiffness * share * after_touch * u[axis];
      q = returnToCone(q, friction.friction_coefficient * pressure);
      shear.state.history[n] = q;
    }
    if (point.taxel != kNoTaxel) {
      for (std::size_t axis = 0; axis < 2; ++axis) shear.taxel_force[static_cast<std::size_t>(point.taxel)][axis] += q[axis] * point.area;
    }
    const Vector3 point_force = rotate(X_SP.rotation, {q[0] * point.area, q[1] * point.area, 0});
    force = add(force, point_force);
    torque = add(torque, cross(p_S, point_force));
  }
  shear.wrench = {force[0], force[1], force[2], torque[0], torque[1], torque[2]};
  return shear;
}

}  // namespace taxelsim::reference
