#include "episodes/clearance.h"
#include "base/constants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taxelsim {
namespace {

// Box around the taxels, in S.
Bounds taxelBounds(const Sensor& sensor) {
  Bounds bounds{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (const GridPatch& patch : sensor.patches) {
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        const Vector3 corner = patch.X_SP * Vector3{x * patch.num_rows * patch.pitch[0], y * patch.num_cols * patch.pitch[1], 0};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          bounds.min[axis] = std::min(bounds.min[axis], corner[axis]);
          bounds.max[axis] = std::max(bounds.max[axis], corner[axis]);
        }
      }
    }
  }
  return bounds;
}

bool isFinite(const Bounds& bounds) {
  return std::ranges::all_of(bounds.min, [](double x) { return std::isfinite(x); }) &&
         std::ranges::all_of(bounds.max, [](double x) { return std::isfinite(x); });
}

// Distance between box a, in A, and the box in A around box b, in B. b is finite.
double distance(const Bounds& a, const Bounds& b, const Pose& X_AB) {
  const std::array<double, 9> R = rotationMatrix(X_AB.rotation);
  double square = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double middle = X_AB.position[axis], half = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      middle += R[3 * axis + k] * (b.min[k] + b.max[k]) / 2;
      half += std::abs(R[3 * axis + k]) * (b.max[k] - b.min[k]) / 2;
    }
    const double gap = std::max({0.0, a.min[axis] - (middle + half), middle - half - a.max[axis]});
    square += gap * gap;
  }
  return std::sqrt(square);
}

}  // namespace

Clearance::Clearance(const Sensor& sensor, const std::vector<SceneObject>& objects) : taxels_(taxelBounds(sensor)) {
  for (const SceneObject& object : objects) objects_.push_back(boundsOf(object.object));
}

double Clearance::of(std::size_t object, const Pose& X_SO) const {
  const Bounds& bounds = objects_[object];
  const double in_object = distance(bounds, taxels_, inverse(X_SO));
  return isFinite(bounds) ? std::max(in_object, distance(taxels_, bounds, X_SO)) : in_object;
}

double Clearance::of(const Vector3& point) const {
  return distance(taxels_, {point, point}, {});
}

}  // namespace taxelsim
