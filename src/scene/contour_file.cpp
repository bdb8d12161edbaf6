#include <array>
#include <string>

#include "scene/csv_rows.h"
#include "taxelsim/error.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr double kLargest = 1e3;  // m
constexpr std::array<CsvColumn, 3> kColumns = {{{"x_m", kLargest}, {"y_m", kLargest}, {"z_m", kLargest}}};
constexpr std::size_t kLeastPoints = 3;

}  // namespace

std::vector<Vector3> loadContour(const std::filesystem::path& file) {
  std::vector<Vector3> points;
  for (const CsvRow& row : readCsv(file, kColumns, "point")) {
    const Vector3 point{row.numbers[0], row.numbers[1], row.numbers[2]};
    if (!points.empty() && (point == points.back() || point == points.front())) {
      row.fail("a point of the line before or of the first one: the line closes by itself");
    }
    points.push_back(point);
  }
  if (points.size() < kLeastPoints) {
    throw Error(ErrorKind::kInput, file.generic_string() + ": " + std::to_string(points.size()) + " points found, at least " +
                                       std::to_string(kLeastPoints) + " make a closed line");
  }
  return points;
}

}  // namespace taxelsim
