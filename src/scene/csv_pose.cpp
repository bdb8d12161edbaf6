#include "scene/csv_pose.h"

#include <cmath>
#include <string>

#include "base/text.h"

namespace taxelsim {

Pose csvPose(std::span<const double> numbers, std::size_t first, const CsvReader& at) {
  const std::span<const double> p = numbers.subspan(first, 3), q = numbers.subspan(first + 3, 4);
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (std::abs(norm - 1) > kCsvUnitTolerance) {
    at.fail(at.fields()[first + 3].column, "qw,qx,qy,qz: length " + numberText(norm) + " is not allowed: a unit quaternion");
  }
  return {{p[0], p[1], p[2]}, {q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm}};
}

}  // namespace taxelsim
