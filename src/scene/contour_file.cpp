#include <array>
#include <string>

#include "scene/csv_reader.h"
#include "taxelsim/error.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr double kLargestPlace = 1e3;  // m
constexpr std::array<CsvColumn, 3> kContourColumns = {{{"x_m", -kLargestPlace, kLargestPlace, "m"},
                                                       {"y_m", -kLargestPlace, kLargestPlace, "m"},
                                                       {"z_m", -kLargestPlace, kLargestPlace, "m"}}};
constexpr std::size_t kLeastPoints = 3;

}  // namespace

std::vector<Vector3> loadContour(const std::filesystem::path& file) {
  std::vector<Vector3> points;
  readCsvRows(file, {.columns = kContourColumns, .row = "point"}, [&](std::span<const double> numbers, const CsvReader& at) {
    const Vector3 point{numbers[0], numbers[1], numbers[2]};
    if (!points.empty() && (point == points.back() || point == points.front())) {
      at.fail(1, "repeats the previous or the first point: a contour is closed implicitly");
    }
    points.push_back(point);
  });
  if (points.size() < kLeastPoints) {
    throw Error(ErrorKind::kInput, file.generic_string() + ": " + std::to_string(points.size()) +
                                       " points found, a closed contour needs at least " + std::to_string(kLeastPoints));
  }
  return points;
}

}  // namespace taxelsim
