#include "scene/contact_recording_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/text.h"
#include "scene/csv_reader.h"
#include "scene/hashed_file.h"
#include "scene/pose_reader.h"
#include "scene/scene_fields.h"
#include "scene/sensor_poses_file.h"
#include "sensor/skin.h"
#include "taxelsim/simulator.h"

namespace taxelsim {
namespace {

constexpr std::uintmax_t kMaxRecordingBytes = std::uintmax_t{1} << 30;
constexpr std::size_t kMaxRecordedPoints = 10'000'000;

enum Column : std::size_t { kEpisode, kStep, kX, kNormalForce = 5, kForceX = 5 };

constexpr CsvColumn coordinate(std::string_view name) {
  return {name, -kMaxContactCoordinate, kMaxContactCoordinate, "m"};
}
constexpr CsvColumn component(std::string_view name) {
  return {name, -kMaxContactForce, kMaxContactForce, "N"};
}

// What the block says about the file.
struct Format {
  std::filesystem::path file;
  std::optional<std::uint64_t> num_episodes;  // empty: those that the file has
  int num_steps;
  Pose X_SF = {};                     // F: frame of positions and forces
  std::optional<SensorPoses> X_WS{};  // where F is the world and the sensor moves; then X_SF is not used
  bool takes_vectors = false;         // whether a force vector has one normal component for all taxels
};

// Rows of a file in its order.
struct Rows {
  std::vector<ContactRecording::Frame> frames;  // of each row
  std::vector<ContactPoint> points;
};

std::vector<CsvColumn> columnsOf(const Format& format, bool has_vectors) {
  const auto last_episode = static_cast<double>(format.num_episodes.value_or(kMaxRecordedEpisodes) - 1);
  std::vector<CsvColumn> columns{{"episode", 0, last_episode},
                                 {"step", 0, static_cast<double>(format.num_steps - 1)},
                                 coordinate("x_m"),
                                 coordinate("y_m"),
                                 coordinate("z_m")};
  if (has_vectors) {
    for (const std::string_view name : {"fx_N", "fy_N", "fz_N"}) columns.push_back(component(name));
  } else {
    columns.push_back({"normal_force_N", 0, kMaxContactForce, "N"});
  }
  return columns;
}

// The columns by the heading, on which the reader is.
std::vector<CsvColumn> columnsOf(const CsvReader& reader, const Format& format) {
  if (std::vector<CsvColumn> columns = columnsOf(format, false); isHeading(reader, columns)) return columns;
  std::vector<CsvColumn> columns = columnsOf(format, true);
  if (!isHeading(reader, columns)) {
    reader.fail(
        1, "missing heading: the first line must be episode,step,x_m,y_m,z_m,normal_force_N or episode,step,x_m,y_m,z_m,fx_N,fy_N,fz_N");
  }
  if (!format.takes_vectors) {
    reader.fail(reader.fields()[kForceX].column,
                "fx_N,fy_N,fz_N are not allowed for a sensor whose taxels have different normals: normal_force_N");
  }
  return columns;
}

// X_SF in a frame of the recording.
Pose frameAt(const CsvReader& at, const Format& format, std::uint64_t episode, std::uint64_t step) {
  if (!format.X_WS) return format.X_SF;
  if (const Pose* const X_WS = format.X_WS->find(episode, step)) return inverse(*X_WS);
  at.fail(1, "sensor_poses has no pose of the sensor at or before step " + std::to_string(step) + " of episode " + std::to_string(episode));
}

ContactPoint pointOf(std::span<const double> n, const CsvReader& at, const Pose& X_SF) {
  ContactPoint point{X_SF * Vector3{n[kX], n[kX + 1], n[kX + 2]}, n[kNormalForce]};
  // A point that pulls on the skin presses with no force.
  if (n.size() > kNormalForce + 1)
    point.normal_force = std::max(-rotate(X_SF.rotation, {n[kForceX], n[kForceX + 1], n[kForceX + 2]})[2], 0.0);
  for (const double c : point.position) {
    if (std::abs(c) > kMaxContactCoordinate) {
      at.fail(at.fields()[kX].column, "x_m,y_m,z_m: " + numberText(c) + " m in the frame of the sensor is not allowed: at most " +
                                          numberText(kMaxContactCoordinate) + " m from it along each axis");
    }
  }
  if (point.normal_force > kMaxContactForce) {
    at.fail(at.fields()[kForceX].column, "fx_N,fy_N,fz_N: a normal force of " + numberText(point.normal_force) +
                                             " N is not allowed: at most " + numberText(kMaxContactForce) + " N");
  }
  return point;
}

Rows readRows(const Format& format) {
  CsvReader reader(format.file, kMaxRecordingBytes);
  if (!reader.next()) reader.fail(1, "no contact point found: an empty file");
  const std::vector<CsvColumn> columns = columnsOf(reader, format);
  std::unordered_map<std::uint64_t, int> num_points;  // by frame
  Rows rows;
  while (reader.next()) {
    if (rows.points.size() == kMaxRecordedPoints) reader.fail(1, "more than " + std::to_string(kMaxRecordedPoints) + " contact points");
    const std::vector<double> numbers = reader.numbers(columns);
    const std::uint64_t episode = reader.wholeNumber(kEpisode, columns[kEpisode]);
    const std::uint64_t step = reader.wholeNumber(kStep, columns[kStep]);
    if (++num_points[episode * static_cast<std::uint64_t>(format.num_steps) + step] > kMaxContacts) {
      reader.fail(1, "more than " + std::to_string(kMaxContacts) + " contact points in step " + std::to_string(step) + " of episode " +
                         std::to_string(episode));
    }
    rows.points.push_back(pointOf(numbers, reader, frameAt(reader, format, episode, step)));
    rows.frames.push_back({.episode = episode, .step = static_cast<int>(step)});
  }
  if (rows.points.empty()) reader.fail(1, "no contact point found: the file needs at least one line after its heading");
  return rows;
}

bool isBefore(const ContactRecording::Frame& a, const ContactRecording::Frame& b) {
  return a.episode != b.episode ? a.episode < b.episode : a.step < b.step;
}

// Engines write episode after episode, or step after step of all episodes.
void sortInto(const Rows& rows, ContactRecording& recording) {
  std::vector<std::size_t> order(rows.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return isBefore(rows.frames[a], rows.frames[b]); });
  recording.points.reserve(order.size());
  for (const std::size_t row : order) {
    const ContactRecording::Frame& frame = rows.frames[row];
    if (recording.frames.empty() || isBefore(recording.frames.back(), frame)) {
      recording.frames.push_back({.episode = frame.episode, .step = frame.step, .begin = recording.points.size()});
    }
    recording.points.push_back(rows.points[row]);
  }
}

// The frame of positions and forces.
void readFrame(const YamlMap& map, const std::filesystem::path& directory, Format& format) {
  if (map.wordOf("frame") == 0) {  // sensor
    for (const std::string_view key : {"sensor_pose", "sensor_poses"}) {
      if (const std::optional<YamlNode> node = map.find(key)) node->fail("needs frame: world");
    }
    return;
  }
  map.rejectBoth("sensor_pose", "sensor_poses");
  if (!map.has("sensor_poses")) {
    map.require("sensor_pose", "X_WS, the pose of the sensor in the world; or sensor_poses of a sensor that moves");
    format.X_SF = inverse(readPose(map, "sensor_pose"));
    return;
  }
  const YamlMap block(map, "sensor_poses");
  const std::filesystem::path file = readHashedFile(block, "file", directory, kMaxRecordingBytes);
  const auto last_step = static_cast<std::uint64_t>(format.num_steps - 1);
  format.X_WS =
      atNode(block.require("file"), [&] { return SensorPoses(file, format.num_episodes.value_or(kMaxRecordedEpisodes) - 1, last_step); });
}

}  // namespace

std::span<const ContactPoint> ContactRecording::pointsOf(std::uint64_t episode, int step) const {
  const Frame wanted{.episode = episode, .step = step};
  const auto found = std::lower_bound(frames.begin(), frames.end(), wanted, isBefore);
  if (found == frames.end() || isBefore(wanted, *found)) return {};
  const std::size_t end = found + 1 == frames.end() ? points.size() : (found + 1)->begin;
  return std::span(points).subspan(found->begin, end - found->begin);
}

int ContactRecording::maxPoints() const {
  std::size_t most = 0;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    most = std::max(most, (k + 1 == frames.size() ? points.size() : frames[k + 1].begin) - frames[k].begin);
  }
  return static_cast<int>(most);
}

ContactRecording readContactRecording(const YamlMap& map, const std::filesystem::path& directory, const Scene& scene) {
  map.require("contact_points");
  const YamlMap block(map, "contact_points");
  ContactRecording recording;
  Format format{.file = readHashedFile(block, "file", directory, kMaxRecordingBytes, &recording.sha256),
                .num_episodes = {},
                .num_steps = scene.num_steps,
                .takes_vectors = isLevel(scene.sensor)};
  if (const std::optional<YamlNode> number = block.find("num_episodes")) format.num_episodes = number->integer(1, kMaxRecordedEpisodes);
  recording.file_name = format.file.filename().string();
  readFrame(block, directory, format);
  readFields(block, kContactBandFields, recording);
  sortInto(atNode(block.require("file"), [&] { return readRows(format); }), recording);
  recording.num_episodes = format.num_episodes.value_or(recording.frames.back().episode + 1);
  block.canonical().line("num_episodes", std::to_string(recording.num_episodes));
  return recording;
}

}  // namespace taxelsim
