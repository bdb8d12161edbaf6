// Helpers of the closed forms of friction: sensors of a given sample spacing, and paths of one object.
#pragma once

#include "support/friction_cases.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim::support {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kStiffness = 1.73e8;  // k, N/m^3
inline constexpr double kThickness = 2e-3;    // m
// Partial slip displaces by at most this fraction of the depth, so that the contact area stays almost the same.
inline constexpr double kStiff = 25;  // k_t / k
inline constexpr double kMu = 0.5;

// A square sensor of `side` (m) with samples `step` (m) apart.
inline Sensor sensorWithStep(double step, double side, double tangential_stiffness, double friction_coefficient) {
  const int taxels = static_cast<int>(std::ceil(side / (4 * step)));
  Sensor sensor = gridSensor({.num_rows = taxels,
                              .num_cols = taxels,
                              .pitch_x = 4 * step,
                              .pitch_y = 4 * step,
                              .samples_per_taxel = 4,
                              .thickness = kThickness,
                              .law = {kStiffness, 1, 0}});
  sensor.skin.friction = {tangential_stiffness, friction_coefficient};
  return sensor;
}

// A path through `positions` with a constant rotation.
inline Path pathOf(const std::vector<Vector3>& positions, const Quaternion& R_SO = {1, 0, 0, 0}) {
  Path path;
  for (const Vector3& p : positions) path.push_back({p, R_SO});
  return path;
}

inline std::vector<Push> simulateOne(const FrictionCases& cases, const Sensor& sensor, const Object& object, const Path& path) {
  return cases.simulate(sensor, object, {path}).front();
}

inline double torqueAbout(const Push& push, double x, double y) {
  return push.wrench[5] - (x * push.wrench[1] - y * push.wrench[0]);
}

// Pose of a body rotated by `angle` (rad) about z.
inline Pose turned(const Vector3& position, double angle) {
  return {position, axisAngle({0, 0, 1}, angle)};
}

}  // namespace taxelsim::support
