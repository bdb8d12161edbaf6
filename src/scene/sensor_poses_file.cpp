#include "scene/sensor_poses_file.h"

#include <algorithm>
#include <set>
#include <string>

#include "scene/csv_pose.h"

namespace taxelsim {
namespace {

constexpr std::uintmax_t kMaxSensorPosesBytes = std::uintmax_t{1} << 28;
constexpr std::size_t kMaxSensorPoses = 1'000'000;

}  // namespace

SensorPoses::SensorPoses(const std::filesystem::path& file, std::uint64_t max_episode, std::uint64_t max_step) {
  std::vector<CsvColumn> columns{{"episode", 0, static_cast<double>(max_episode)}, {"step", 0, static_cast<double>(max_step)}};
  columns.insert(columns.end(), kPoseColumns.begin(), kPoseColumns.end());
  const CsvFormat format{.columns = columns, .row = "pose of the sensor", .max_rows = kMaxSensorPoses, .max_bytes = kMaxSensorPosesBytes};
  std::set<Frame> given;
  readCsvRows(file, format, [&](std::span<const double> numbers, const CsvReader& at) {
    const Frame frame{at.wholeNumber(0, columns[0]), at.wholeNumber(1, columns[1])};
    if (!given.insert(frame).second) {
      at.fail(1, "step " + std::to_string(frame.second) + " of episode " + std::to_string(frame.first) + " is given twice");
    }
    rows_.emplace_back(frame, csvPose(numbers, 2, at));
  });
  std::sort(rows_.begin(), rows_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
}

const Pose* SensorPoses::find(std::uint64_t episode, std::uint64_t step) const {
  const Frame frame{episode, step};
  const auto after = std::upper_bound(rows_.begin(), rows_.end(), frame, [](const Frame& a, const auto& row) { return a < row.first; });
  if (after == rows_.begin() || std::prev(after)->first.first != episode) return nullptr;
  return &std::prev(after)->second;
}

}  // namespace taxelsim
