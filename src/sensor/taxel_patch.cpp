#include <algorithm>
#include <cmath>
#include <utility>

#include "base/vector3.h"
#include "taxelsim/error.h"
#include "taxelsim/sensor.h"

namespace taxelsim {
namespace {

// Sine of the smallest angle between x_axis and normal: below it, rounding dominates the direction in the plane.
constexpr double kLeastAngle = 1e-3;

Vector3 directionOf(const char* field, const Vector3& vector) {
  // Division by the largest component prevents overflow and underflow of squares.
  const double largest = std::max({std::abs(vector[0]), std::abs(vector[1]), std::abs(vector[2])});
  if (!(std::isfinite(vector[0]) && std::isfinite(vector[1]) && std::isfinite(vector[2]) && largest > 0)) {
    throw Error(ErrorKind::kInput, std::string(field) + ": no direction: three finite numbers, not all 0");
  }
  return unit({vector[0] / largest, vector[1] / largest, vector[2] / largest});
}

// The shortest rotation from z to n.
Quaternion turnFromZ(const Vector3& n) {
  const double w = 1 + n[2];
  if (w < 1e-12) return {0, 0, 1, 0};  // 180 deg about y; all axes in the plane are equivalent
  const double norm = std::sqrt(w * w + n[0] * n[0] + n[1] * n[1]);
  return {w / norm, -n[1] / norm, n[0] / norm, 0};
}

}  // namespace

GridPatch taxelPatch(std::string name, const Vector3& position, const Vector3& normal, const std::array<double, 2>& size,
                     const std::optional<Vector3>& x_axis) {
  const Vector3 n = directionOf("normal", normal);
  GridPatch patch{.name = std::move(name), .num_rows = 1, .num_cols = 1, .pitch = size, .X_SP = {position, turnFromZ(n)}};
  if (x_axis) {
    const Vector3 wanted = directionOf("x_axis", *x_axis);
    const Vector3 x = rotate(patch.X_SP.rotation, {1, 0, 0}), y = rotate(patch.X_SP.rotation, {0, 1, 0});
    const double along_x = dot(wanted, x), along_y = dot(wanted, y);
    if (std::hypot(along_x, along_y) < kLeastAngle) throw Error(ErrorKind::kInput, "x_axis: runs along the normal; it must lie across");
    patch.X_SP.rotation = patch.X_SP.rotation * axisAngle({0, 0, 1}, std::atan2(along_y, along_x));
  }
  return patch;
}

}  // namespace taxelsim
