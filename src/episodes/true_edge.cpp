#include "episodes/true_edge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/constants.h"
#include "base/vector3.h"

namespace taxelsim {
namespace {

constexpr double kMinProjection = 1e-9;  // length of a projected unit direction below which the angle is undefined
// Excess of a squared distance over the smallest one so far at which its root cannot be the smaller one: some roundings of a double.
constexpr double kFarther = 1 + 1e-12;

double lineAngle(double x, double y) {
  if (std::hypot(x, y) < kMinProjection) return kNaN;
  const double angle = std::remainder(std::atan2(y, x), std::numbers::pi);
  return angle <= -std::numbers::pi / 2 ? angle + std::numbers::pi : angle;
}

}  // namespace

TrueEdge::TrueEdge(const SceneObject& object) : direction_(object.edge), contour_(object.contour) {
  if (contour_.empty()) return;
  contour_.push_back(contour_.front());
  arc_.push_back(0);
  for (std::size_t k = 1; k < contour_.size(); ++k) arc_.push_back(arc_.back() + length(subtract(contour_[k], contour_[k - 1])));
}

ProjectedEdge TrueEdge::project(const Pose& X_SO) const {
  if (direction_) {
    const Vector3 along = rotate(X_SO.rotation, *direction_);
    return {lineAngle(along[0], along[1]), kNaN, kNaN};
  }
  // Axes of the plane in O.
  const Quaternion R_OS = inverse(X_SO).rotation;
  const Vector3 x_axis = rotate(R_OS, {1, 0, 0}), y_axis = rotate(R_OS, {0, 1, 0});
  struct {
    double distance = std::numeric_limits<double>::infinity(), squared = distance;
    double along[2] = {0, 0}, part = 0;
    std::size_t end = 0;  // of the segment; 0: none
  } nearest;
  double from[2] = {0, 0};
  for (std::size_t k = 0; k < contour_.size(); ++k) {
    const double to[2] = {dot(x_axis, contour_[k]) + X_SO.position[0], dot(y_axis, contour_[k]) + X_SO.position[1]};
    if (k > 0) {
      const double along[2] = {to[0] - from[0], to[1] - from[1]};
      const double squared_length = along[0] * along[0] + along[1] * along[1];
      const double part = squared_length > 0 ? std::clamp(-(from[0] * along[0] + from[1] * along[1]) / squared_length, 0.0, 1.0) : 0;
      const double x = from[0] + part * along[0], y = from[1] + part * along[1];
      const double squared = x * x + y * y;
      if (squared <= kFarther * nearest.squared) {
        const double distance = std::hypot(x, y);
        if (distance < nearest.distance) nearest = {distance, squared, {along[0], along[1]}, part, k};
      }
    }
    from[0] = to[0];
    from[1] = to[1];
  }
  if (nearest.end == 0) return {kNaN, kNaN, kNaN};
  const double arc = arc_[nearest.end - 1] + nearest.part * (arc_[nearest.end] - arc_[nearest.end - 1]);
  return {lineAngle(nearest.along[0], nearest.along[1]), nearest.distance, arc};
}

TrueEdge::ContourPoint TrueEdge::at(double arc) const {
  const auto after = std::upper_bound(arc_.begin() + 1, arc_.end() - 1, arc);
  const auto k = static_cast<std::size_t>(after - arc_.begin());
  const Vector3 along = subtract(contour_[k], contour_[k - 1]);
  const double part = std::clamp((arc - arc_[k - 1]) / (arc_[k] - arc_[k - 1]), 0.0, 1.0);
  return {add(contour_[k - 1], scale(part, along)), unit(along)};
}

}  // namespace taxelsim
