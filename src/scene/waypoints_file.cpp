#include <array>
#include <cmath>

#include "base/text.h"
#include "scene/csv_reader.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr double kLargest = 1e6;         // s and m
constexpr double kUnitTolerance = 1e-3;  // a quaternion of unit length written with four digits
constexpr double kLargestPart = 1 + kUnitTolerance;
constexpr std::array<CsvColumn, 8> kColumns = {{{"time_s", -kLargest, kLargest, "s"},
                                                {"x_m", -kLargest, kLargest, "m"},
                                                {"y_m", -kLargest, kLargest, "m"},
                                                {"z_m", -kLargest, kLargest, "m"},
                                                {"qw", -kLargestPart, kLargestPart},
                                                {"qx", -kLargestPart, kLargestPart},
                                                {"qy", -kLargestPart, kLargestPart},
                                                {"qz", -kLargestPart, kLargestPart}}};

Waypoint waypointOf(std::span<const double> n, const CsvReader& at) {
  const double norm = std::sqrt(n[4] * n[4] + n[5] * n[5] + n[6] * n[6] + n[7] * n[7]);
  if (std::abs(norm - 1) > kUnitTolerance) {
    at.fail(at.fields()[4].column, "qw,qx,qy,qz: length " + numberText(norm) + " is not allowed: a unit quaternion");
  }
  return {n[0], {{n[1], n[2], n[3]}, {n[4] / norm, n[5] / norm, n[6] / norm, n[7] / norm}}};
}

}  // namespace

std::vector<Waypoint> loadWaypoints(const std::filesystem::path& file) {
  std::vector<Waypoint> points;
  readCsvRows(file, {.columns = kColumns, .row = "waypoint"}, [&](std::span<const double> numbers, const CsvReader& at) {
    const Waypoint point = waypointOf(numbers, at);
    if (!points.empty() && point.time <= points.back().time) {
      at.fail(1, "time_s: " + numberText(point.time) + " is not allowed: must be later than the previous waypoint (" +
                     numberText(points.back().time) + " s)");
    }
    points.push_back(point);
  });
  return points;
}

}  // namespace taxelsim
