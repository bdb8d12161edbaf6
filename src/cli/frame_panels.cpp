#include "cli/frame_panels.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/text.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

constexpr std::size_t kTaxelsPerLine = 16;  // for sensors without a single grid
constexpr const char* kTimeColumn = "data/time";
constexpr std::array kShown{kTactileImage, kTaxelCounts,      "total_force",        "ground_truth/total_force",
                            "edge_angle",  "edge_confidence", "center_of_pressure", "eigenvalues"};

}  // namespace

const Column* findColumn(const Manifest& manifest, const std::string& name) {
  const auto column = std::find_if(manifest.columns.begin(), manifest.columns.end(), [&](const Column& c) { return c.name == name; });
  return column == manifest.columns.end() ? nullptr : &*column;
}

std::string imageGroup(const Manifest& manifest, const std::string& sensor, const std::string& directory) {
  const std::string end = std::string("/") + kTactileImage, data = kData;
  std::vector<std::string> sensors;
  for (const Column& column : manifest.columns) {
    if (sensor.empty() && column.name == data + kTactileImage) return data;
    if (column.name.ends_with(end) && column.name.size() > data.size() + end.size()) {
      sensors.push_back(column.name.substr(data.size(), column.name.size() - data.size() - end.size()));
    }
  }
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

std::string shownColumn(const Manifest& manifest, const std::string& group) {
  return group + (findColumn(manifest, group + kTaxelCounts) != nullptr ? kTaxelCounts : kTactileImage);
}

std::vector<TaxelOutline> outlinesOf(const Manifest& manifest) {
  const std::optional<Sensor> listed = listedTaxels(manifest);
  return listed ? unrolled(*listed) : std::vector<TaxelOutline>{};
}

FramePanels::FramePanels(const DatasetReader& reader, std::string group, std::vector<TaxelOutline> outlines, double least_shear,
                         std::uint64_t first, std::uint64_t count)
    : manifest_(reader.manifest()),
      group_(std::move(group)),
      outlines_(std::move(outlines)),
      least_shear_(least_shear),
      first_(first),
      count_(count) {
  const auto readColumn = [&](const std::string& key, const std::string& name) {
    const Column* const column = findColumn(manifest_, name);
    if (column != nullptr && !column->per_episode) columns_[key] = reader.readAsDouble(name, first, count);
  };
  readColumn(kTimeColumn, kTimeColumn);
  for (const char* const name : kShown) readColumn(name, group_ + name);
}

// One row of a column; empty if the column is missing.
std::vector<double> FramePanels::row(const std::string& name, std::uint64_t frame) const {
  const auto found = columns_.find(name);
  if (found == columns_.end()) return {};
  const auto width = static_cast<std::ptrdiff_t>(found->second.size() / count_);
  const auto begin = found->second.begin() + static_cast<std::ptrdiff_t>(frame - first_) * width;
  return {begin, begin + width};
}

// Empty also if the row has another length.
std::vector<double> FramePanels::row(const std::string& name, std::uint64_t frame, std::size_t length) const {
  std::vector<double> values = row(name, frame);
  return values.size() == length ? values : std::vector<double>{};
}

// A grid as an image, a list of taxels by their outlines if known, any other sensor as rows of taxels in storage order.
TactilePanel FramePanels::imageOf(std::uint64_t frame) const {
  TactilePanel panel;
  panel.values = row(kTactileImage, frame);
  if (manifest_.num_rows > 0) {
    panel.num_rows = manifest_.num_rows;
    panel.num_cols = manifest_.num_cols;
    panel.values.resize(static_cast<std::size_t>(manifest_.num_rows) * static_cast<std::size_t>(manifest_.num_cols));
    if (manifest_.pitch[0] > 0 && manifest_.pitch[1] > 0) panel.pitch = manifest_.pitch;
    return panel;
  }
  const std::vector<std::size_t>& shape = image().shape;
  if (group_ != kData && shape.size() == 2) {
    panel.num_rows = static_cast<int>(shape[0]);
    panel.num_cols = static_cast<int>(shape[1]);
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
void FramePanels::showThreeAxes(TactilePanel& panel, std::uint64_t frame) const {
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
std::optional<ContactAxes> FramePanels::axesOf(const TactilePanel& panel, std::uint64_t frame) const {
  if (!panel.neighbours) return std::nullopt;
  std::optional<ContactAxes> axes = axesOfImage(panel);
  if (!axes || panel.pitch != manifest_.pitch) return axes;
  const std::vector<double> centre = row("center_of_pressure", frame, 3);
  const std::vector<double> eigenvalues = row("eigenvalues", frame, 2);
  const std::vector<double> angle = row("edge_angle", frame, 1);
  if (!centre.empty()) axes->centre = {centre[0], centre[1]};
  if (!eigenvalues.empty()) axes->eigenvalues = {eigenvalues[0], eigenvalues[1]};
  if (!angle.empty()) axes->angle = angle[0];
  return axes;
}

// The measured force, the true one, or the sum of the image, whichever is recorded.
std::string FramePanels::forceText(const TactilePanel& panel, std::uint64_t frame) const {
  if (const auto force = row("total_force", frame, 1); !force.empty()) return fmt::format("{:.3g} N", force[0]);
  if (const auto force = row("ground_truth/total_force", frame, 1); !force.empty()) return fmt::format("{:.3g} N (true)", force[0]);
  double sum = 0;
  for (const double value : panel.values) sum += std::isnan(value) ? 0 : value;
  return fmt::format("sum {:.4g} {}", sum, image().unit);
}

std::string FramePanels::captionOf(const TactilePanel& panel, std::uint64_t frame) const {
  std::vector<std::string> parts;
  if (const auto time = row(kTimeColumn, frame, 1); !time.empty()) parts.push_back(fmt::format("{:.3f} s", time[0]));
  parts.push_back(forceText(panel, frame));
  const auto confidence = row("edge_confidence", frame, 1);
  const bool undefined = !confidence.empty() && !(confidence[0] > 0);
  if (const auto angle = row("edge_angle", frame, 1); !angle.empty() && !undefined)
    parts.push_back(fmt::format("angle {:.1f}°", angle[0] * 180 / std::numbers::pi));
  if (!confidence.empty()) parts.push_back(fmt::format("confidence {:.2f}", confidence[0]));
  if (!panel.neighbours) parts.push_back(panel.outlines.empty() ? "taxels in storage order" : "unrolled");
  return fmt::format("{}", fmt::join(parts, "   "));
}

TactilePanel FramePanels::panelOf(std::uint64_t frame) const {
  TactilePanel panel = imageOf(frame);
  panel.caption = captionOf(panel, frame);
  showThreeAxes(panel, frame);
  panel.axes = axesOf(panel, frame);
  return panel;
}

}  // namespace taxelsim::cli
