#include <array>
#include <cmath>

#include "base/text.h"
#include "scene/csv_rows.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr double kLargest = 1e6;         // s and m
constexpr double kUnitTolerance = 1e-3;  // a quaternion written with four digits is of unit length within this
constexpr double kLargestPart = 1 + kUnitTolerance;
constexpr std::array<CsvColumn, 8> kColumns = {{{"time_s", kLargest},
                                                {"x_m", kLargest},
                                                {"y_m", kLargest},
                                                {"z_m", kLargest},
                                                {"qw", kLargestPart},
                                                {"qx", kLargestPart},
                                                {"qy", kLargestPart},
                                                {"qz", kLargestPart}}};

Waypoint waypointOf(const CsvRow& row) {
  const std::vector<double>& n = row.numbers;
  const double norm = std::sqrt(n[4] * n[4] + n[5] * n[5] + n[6] * n[6] + n[7] * n[7]);
  if (std::abs(norm - 1) > kUnitTolerance) row.fail("qw,qx,qy,qz: length " + numberText(norm) + " is not allowed: a unit quaternion");
  return {n[0], {{n[1], n[2], n[3]}, {n[4] / norm, n[5] / norm, n[6] / norm, n[7] / norm}}};
}

}  // namespace

std::vector<Waypoint> loadWaypoints(const std::filesystem::path& file) {
  std::vector<Waypoint> points;
  for (const CsvRow& row : readCsv(file, kColumns, "waypoint")) {
    const Waypoint point = waypointOf(row);
    if (!points.empty() && point.time <= points.back().time) {
      row.fail("time_s: " + numberText(point.time) + " is not allowed: later than the line before (" + numberText(points.back().time) +
               ")");
    }
    points.push_back(point);
  }
  return points;
}

}  // namespace taxelsim
