#include <array>

#include "base/text.h"
#include "scene/csv_pose.h"
#include "scene/csv_reader.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr double kLargestTime = 1e6;  // s
constexpr std::array<CsvColumn, 8> kWaypointColumns = {{{"time_s", -kLargestTime, kLargestTime, "s"},
                                                        kPoseColumns[0],
                                                        kPoseColumns[1],
                                                        kPoseColumns[2],
                                                        kPoseColumns[3],
                                                        kPoseColumns[4],
                                                        kPoseColumns[5],
                                                        kPoseColumns[6]}};

}  // namespace

std::vector<Waypoint> loadWaypoints(const std::filesystem::path& file) {
  std::vector<Waypoint> points;
  readCsvRows(file, {.columns = kWaypointColumns, .row = "waypoint"}, [&](std::span<const double> numbers, const CsvReader& at) {
    const Waypoint point{numbers[0], csvPose(numbers, 1, at)};
    if (!points.empty() && point.time <= points.back().time) {
      at.fail(1, "time_s: " + numberText(point.time) + " is not allowed: must be later than the previous waypoint (" +
                     numberText(points.back().time) + " s)");
    }
    points.push_back(point);
  });
  return points;
}

}  // namespace taxelsim
