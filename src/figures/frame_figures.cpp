#include "figures/frame_figures.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/log.h"
#include "base/text.h"
#include "figures/recorded_scene.h"
#include "figures/taxel_chart.h"
#include "figures/text.h"
#include "taxelsim/counts_range.h"
#include "taxelsim/error.h"

namespace taxelsim::figures {
namespace {

constexpr std::uint64_t kFramesAtOnce = 1024;  // largest number that pictures hold in memory
constexpr std::size_t kTaxelsPerLine = 16;     // a sensor that is not one grid has no other shape
constexpr const char* kData = "data/";         // group of the columns of one sensor, unless a data set has one for each: "data/NAME/"
constexpr const char* kTactileImage = "tactile_image";  // below its group
constexpr const char* kTaxelCounts = "taxel_counts";    // as above, of three-axis taxels
constexpr const char* kTime = "data/time";
constexpr const char* kObject = "meta/object";
constexpr const char* kObjectName = "meta/object_name";
constexpr std::array kShown{kTactileImage, kTaxelCounts,      "total_force",        "ground_truth/total_force",
                            "edge_angle",  "edge_confidence", "center_of_pressure", "eigenvalues"};

// The column of that name, or none.
const Column* findColumn(const Manifest& manifest, const std::string& name) {
  const auto column = std::find_if(manifest.columns.begin(), manifest.columns.end(), [&](const Column& c) { return c.name == name; });
  return column == manifest.columns.end() ? nullptr : &*column;
}

// Numbers of the episodes that are there, (num_episodes): their places, unless the data set is one of chosen episodes.
std::vector<std::uint64_t> episodeNumbers(const DatasetReader& reader) {
  std::vector<std::uint64_t> numbers(reader.numEpisodes());
  std::iota(numbers.begin(), numbers.end(), std::uint64_t{0});
  const Manifest& manifest = reader.manifest();
  if (manifest.episodes.empty()) return numbers;
  numbers.clear();
  for (std::uint64_t row = 0; row < manifest.num_episodes; ++row) {
    const std::uint64_t shard = row / manifest.episodes_per_shard;
    if (!std::binary_search(reader.missingShards().begin(), reader.missingShards().end(), shard)) numbers.push_back(manifest.episodes[row]);
  }
  return numbers;
}

// Index of the episode of that number.
std::size_t rowOf(std::uint64_t episode, const std::string& directory, const std::vector<std::uint64_t>& numbers) {
  const auto found = std::find(numbers.begin(), numbers.end(), episode);
  if (found != numbers.end()) return static_cast<std::size_t>(found - numbers.begin());
  static constexpr std::size_t kMost = 8;
  const auto end = numbers.begin() + static_cast<std::ptrdiff_t>(std::min(numbers.size(), kMost));
  const std::string allowed = numbers.back() == numbers.size() - 1
                                  ? fmt::format("0 to {}", numbers.back())
                                  : fmt::format("{}{}", fmt::join(numbers.begin(), end, ", "), numbers.size() > kMost ? ", ..." : "");
  throw Error(ErrorKind::kInput, fmt::format("--episode {}: {} has episodes {}", episode, directory, allowed));
}

}  // namespace

std::vector<std::string> sensorsWithImages(const Manifest& manifest) {
  const std::string end = std::string("/") + kTactileImage, data = kData;
  std::vector<std::string> sensors;
  for (const Column& column : manifest.columns) {
    if (column.name.ends_with(end) && column.name.size() > data.size() + end.size()) {
      sensors.push_back(column.name.substr(data.size(), column.name.size() - data.size() - end.size()));
    }
  }
  return sensors;
}

std::string imageGroup(const Manifest& manifest, const std::string& sensor, const std::string& directory) {
  const std::string data = kData;
  if (sensor.empty() && findColumn(manifest, data + kTactileImage) != nullptr) return data;
  const std::vector<std::string> sensors = sensorsWithImages(manifest);
  if (sensors.empty()) {
    throw Error(ErrorKind::kInput, directory + (sensor.empty() ? ": no column data/tactile_image to draw"
                                                               : ": --sensor: its columns are not grouped by sensor"));
  }
  if (sensor.empty()) return data + sensors.front() + "/";
  if (std::find(sensors.begin(), sensors.end(), sensor) == sensors.end()) {
    throw Error(ErrorKind::kInput,
                oneLine(fmt::format("{}: --sensor {}: its sensors are {}", directory, sensor, fmt::join(sensors, ", "))));
  }
  return data + sensor + "/";
}

std::string sceneName(const Manifest& manifest) {
  try {
    const YAML::Node name = YAML::Load(manifest.scene)["name"];
    if (name && name.IsScalar()) return name.as<std::string>();
  } catch (const YAML::Exception&) {
    return "-";  // the checksum was right; only the name is unknown
  }
  return "-";
}

FrameFigures::FrameFigures(FrameSelection selection)
    : selection_(std::move(selection)),
      reader_(selection_.directory, /*allow_incomplete=*/true, /*isolated=*/true),
      group_(imageGroup(manifest(), selection_.sensor, selection_.directory)),
      image_(*findColumn(manifest(), group_ + kTactileImage)),
      shown_(group_ + (findColumn(manifest(), group_ + kTaxelCounts) != nullptr ? kTaxelCounts : kTactileImage)),
      least_shear_(kShearDeviations * countsNoise(manifest(), shown_)),
      episodes_(episodeNumbers(reader_)) {
  const std::string& directory = selection_.directory;
  if (reader_.numFrames() == 0) throw Error(ErrorKind::kInput, directory + ": no frames yet");
  if (const std::size_t count = reader_.missingShards().size(); count > 0)
    logWarning(fmt::format("{}: {} shards are missing", directory, count));
  const std::optional<Sensor> sensor = group_ == kData ? listedTaxels(manifest()) : recordedSensor(manifest(), sensorName());
  if (sensor && isTaxelList(*sensor)) outlines_ = unrolled(*sensor);
  if (sensor && sensor->patches.size() == 1) pitch_ = sensor->patches[0].pitch;
  const std::vector<std::uint64_t>& ends = reader_.episodeEnds();
  const std::size_t row = selection_.episode ? rowOf(*selection_.episode, directory, episodes_) : 0;
  begin_ = row > 0 ? ends[row - 1] : 0;
  end_ = selection_.episode ? ends[row] : ends.back();
}

std::string FrameFigures::sensorName() const {
  const std::size_t begin = std::string_view(kData).size();
  return group_ == kData ? "" : group_.substr(begin, group_.size() - begin - 1);
}

std::vector<double> FrameFigures::allOf(const std::string& name) const {
  const Column* const column = findColumn(manifest(), name);
  if (column == nullptr || column->per_episode) return {};
  return reader_.readAsDouble(column->name, begin_, numFrames());
}

std::vector<double> FrameFigures::times() const {
  const Column* const time = findColumn(manifest(), kTime);
  if (time == nullptr || time->per_episode || !time->shape.empty())
    throw Error(ErrorKind::kInput, selection_.directory + ": no column data/time with one number per frame");
  return reader_.readAsDouble(kTime, begin_, numFrames());
}

Canvas FrameFigures::figureOf(const std::vector<std::uint64_t>& frames) {
  std::vector<TactilePanel> panels;
  for (const std::uint64_t frame : frames) {
    read(begin_ + frame, 1);
    panels.push_back(describe(begin_ + frame));
  }
  return drawTactileFigure(panels, options());
}

TactilePanel FrameFigures::panelOf(std::uint64_t frame) {
  frame += begin_;
  if (frame < first_ || frame >= first_ + count_) read(frame, std::min(kFramesAtOnce, end_ - frame));
  return describe(frame);
}

Canvas FrameFigures::pictureOf(std::uint64_t frame) {
  return drawTactileFigure({panelOf(frame)}, options());
}

std::vector<double> FrameFigures::valuesOf(const std::string& name, std::size_t width) const {
  const Column* const column = findColumn(manifest(), group_ + name);
  const std::vector<std::size_t> shape = width == 1 ? std::vector<std::size_t>{} : std::vector{width};
  if (column == nullptr || column->per_episode || column->shape != shape) return {};
  return reader_.readAsDouble(column->name, begin_, numFrames());
}

std::vector<double> FrameFigures::edgeAngles() const {
  std::vector<double> angles = valuesOf("edge_angle", 1);
  const std::vector<double> confidence = valuesOf("edge_confidence", 1);
  for (std::size_t k = 0; k < std::min(angles.size(), confidence.size()); ++k) {
    if (!(confidence[k] > 0)) angles[k] = std::numeric_limits<double>::quiet_NaN();
  }
  return angles;
}

std::optional<std::size_t> FrameFigures::objectIndex() const {
  const Column* const column = findColumn(manifest(), kObject);
  if (column == nullptr || !column->per_episode || !column->shape.empty() || !selection_.episode) return std::nullopt;
  const double index = reader_.readAsDouble(kObject, rowOf(*selection_.episode, directory(), episodes_), 1)[0];
  return index >= 0 ? std::optional(static_cast<std::size_t>(index)) : std::nullopt;
}

// Reads what panels show of frames [first, first + count).
void FrameFigures::read(std::uint64_t first, std::uint64_t count) {
  const auto readColumn = [&](const std::string& key, const std::string& name) {
    const Column* const column = findColumn(manifest(), name);
    if (column != nullptr && !column->per_episode) columns_[key] = reader_.readAsDouble(name, first, count);
  };
  count_ = 0;
  readColumn(kTime, kTime);
  for (const char* const name : kShown) readColumn(name, group_ + name);
  first_ = first, count_ = count;
}

// One row of a column; empty if the column is missing.
std::vector<double> FrameFigures::row(const std::string& name, std::uint64_t frame) const {
  const auto found = columns_.find(name);
  if (found == columns_.end()) return {};
  const auto width = static_cast<std::ptrdiff_t>(found->second.size() / count_);
  const auto begin = found->second.begin() + static_cast<std::ptrdiff_t>(frame - first_) * width;
  return {begin, begin + width};
}

// Empty also if the row has another length.
std::vector<double> FrameFigures::row(const std::string& name, std::uint64_t frame, std::size_t length) const {
  std::vector<double> values = row(name, frame);
  return values.size() == length ? values : std::vector<double>{};
}

// A grid as an image, a list of taxels by their outlines if known, any other sensor as rows of taxels in storage order.
TactilePanel FrameFigures::imageOf(std::uint64_t frame) const {
  TactilePanel panel;
  panel.values = row(kTactileImage, frame);
  if (manifest().num_rows > 0) {
    panel.num_rows = manifest().num_rows;
    panel.num_cols = manifest().num_cols;
    panel.values.resize(static_cast<std::size_t>(manifest().num_rows) * static_cast<std::size_t>(manifest().num_cols));
    if (manifest().pitch[0] > 0 && manifest().pitch[1] > 0) panel.pitch = manifest().pitch;
    return panel;
  }
  const std::vector<std::size_t>& shape = image_.shape;
  if (group_ != kData && shape.size() == 2) {
    panel.num_rows = static_cast<int>(shape[0]);
    panel.num_cols = static_cast<int>(shape[1]);
    if (pitch_[0] > 0 && pitch_[1] > 0) panel.pitch = pitch_;
    return panel;
  }
  panel.values.resize(shape.back());
  panel.neighbours = false;
  if (panel.values.size() == outlines_.size()) {
    panel.outlines = outlines_;
    return panel;
  }
  const std::size_t num_cols = std::min(panel.values.size(), kTaxelsPerLine);
  const std::size_t num_rows = (panel.values.size() + num_cols - 1) / num_cols;
  panel.values.resize(num_rows * num_cols, std::numeric_limits<double>::quiet_NaN());
  panel.num_rows = static_cast<int>(num_rows);
  panel.num_cols = static_cast<int>(num_cols);
  return panel;
}

// Replaces the values by the counts along the normal, and adds the arrows. Noise reaches all taxels, so there is no outline.
void FrameFigures::showThreeAxes(TactilePanel& panel, std::uint64_t frame) const {
  const std::vector<double> counts = row(kTaxelCounts, frame);
  if (counts.empty()) return;
  panel.arrows.resize(panel.values.size());
  for (std::size_t t = 0; t < panel.values.size() && 3 * t + 2 < counts.size(); ++t) {
    if (std::isnan(panel.values[t])) continue;  // a cell without a taxel
    panel.values[t] = counts[3 * t + 2];
    if (std::hypot(counts[3 * t], counts[3 * t + 1]) >= least_shear_) panel.arrows[t] = {counts[3 * t], counts[3 * t + 1]};
  }
  panel.neighbours = false;
}

// Recorded features if they are in metres on this grid, otherwise moments of the image.
std::optional<ContactAxes> FrameFigures::axesOf(const TactilePanel& panel, std::uint64_t frame) const {
  if (!panel.neighbours) return std::nullopt;
  std::optional<ContactAxes> axes = axesOfImage(panel);
  if (!axes || panel.pitch != (group_ == kData ? manifest().pitch : pitch_)) return axes;
  const std::vector<double> centre = row("center_of_pressure", frame, 3);
  const std::vector<double> eigenvalues = row("eigenvalues", frame, 2);
  const std::vector<double> angle = row("edge_angle", frame, 1);
  if (!centre.empty()) axes->centre = {centre[0], centre[1]};
  if (!eigenvalues.empty()) axes->eigenvalues = {eigenvalues[0], eigenvalues[1]};
  if (!angle.empty()) axes->angle = angle[0];
  return axes;
}

// The measured force, the true one, or the sum of the image, whichever is recorded.
std::string FrameFigures::forceText(const TactilePanel& panel, std::uint64_t frame) const {
  if (const auto force = row("total_force", frame, 1); !force.empty()) return fmt::format("{:.3g} N", force[0]);
  if (const auto force = row("ground_truth/total_force", frame, 1); !force.empty()) return fmt::format("{:.3g} N (true)", force[0]);
  double sum = 0;
  for (const double value : panel.values) sum += std::isnan(value) ? 0 : value;
  return fmt::format("sum {:.4g} {}", sum, image_.unit);
}

std::string FrameFigures::captionOf(const TactilePanel& panel, std::uint64_t frame) const {
  std::vector<std::string> parts;
  if (const auto time = row(kTime, frame, 1); !time.empty()) parts.push_back(fmt::format("{:.3f} s", time[0]));
  parts.push_back(forceText(panel, frame));
  const auto confidence = row("edge_confidence", frame, 1);
  const bool undefined = !confidence.empty() && !(confidence[0] > 0);
  if (const auto angle = row("edge_angle", frame, 1); !angle.empty() && !undefined)
    parts.push_back(fmt::format("angle {:.1f}°", angle[0] * 180 / std::numbers::pi));
  if (!confidence.empty()) parts.push_back(fmt::format("confidence {:.2f}", confidence[0]));
  if (!panel.neighbours) parts.push_back(panel.outlines.empty() ? "taxels in storage order" : "unrolled");
  return fmt::format("{}", fmt::join(parts, "   "));
}

// Draws the first sensor where a group has several. Three-axis taxels show counts along the normal and arrows, no image and no axes.
TactilePanel FrameFigures::describe(std::uint64_t frame) {
  TactilePanel panel = imageOf(frame);
  panel.title = titleOf(frame);
  panel.caption = captionOf(panel, frame);
  showThreeAxes(panel, frame);
  panel.axes = axesOf(panel, frame);
  return panel;
}

// Episode, frame, and the name of the object.
std::string FrameFigures::titleOf(std::uint64_t frame) {
  const std::vector<std::uint64_t>& ends = reader_.episodeEnds();
  const auto row = static_cast<std::uint64_t>(std::upper_bound(ends.begin(), ends.end(), frame) - ends.begin());
  const Column* const names = findColumn(manifest(), kObjectName);
  if (row != object_row_ && names != nullptr && names->type == ScalarType::kText && names->per_episode)
    object_ = oneLine(reader_.readAsText(kObjectName, row, 1)[0]);
  object_row_ = row;
  return fmt::format("episode {}, frame {}{}{}", episodes_[row], frame - (row > 0 ? ends[row - 1] : 0), object_.empty() ? "" : ": ",
                     object_);
}

// Counts of the brightest colour: those of the whole data set, so that all its pictures and videos have one scale. A broken shard elsewhere
// leaves the frames of an episode.
double FrameFigures::range() const {
  if (selection_.range > 0) return selection_.range;
  try {
    return countsRange(reader_, shown_, 0, reader_.numFrames());
  } catch (const Error& error) {
    if (numFrames() == reader_.numFrames()) throw;
    logWarning(fmt::format("{}; the colours are those of this episode alone", error.what()));
    return countsRange(reader_, shown_, begin_, end_);
  }
}

const FigureOptions& FrameFigures::options() {
  if (options_) return *options_;
  const std::string name = sceneName(manifest());
  options_ = {.title = name == "-" ? selection_.directory : name,
              .subtitle = fmt::format("{}, seed {}, {} episodes, {} frames{}", group_ == kData ? manifest().sensor_name : sensorName(),
                                      manifest().seed, countText(reader_.numEpisodes()), countText(reader_.numFrames()),
                                      shown_.ends_with(kTaxelCounts) ? "; arrows: shear" : ""),
              .unit = image_.unit,
              .range = range()};
  return *options_;
}

}  // namespace taxelsim::figures
