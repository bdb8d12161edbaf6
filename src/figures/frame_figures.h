// Figures of frames of a data set, for `taxelsim render`.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "figures/tactile_figure.h"
#include "taxelsim/dataset.h"

namespace taxelsim::figures {

// "-" if the scene has no name.
std::string sceneName(const Manifest& manifest);

// Names of the sensors whose images a data set has, where columns are grouped by sensor, in their order; empty for one of one sensor.
std::vector<std::string> sensorsWithImages(const Manifest& manifest);

// Begin of the names of the columns of a sensor, "data/thumb/", of the first sensor for an empty name; "data/" for a data set of one
// sensor. Throws Error(kInput), which begins with `directory`, if there is no image of that sensor.
std::string imageGroup(const Manifest& manifest, const std::string& sensor, const std::string& directory);

struct FrameSelection {
  std::string directory, sensor{};         // directory: the data set; sensor: its name, empty for the first
  std::optional<std::uint64_t> episode{};  // none: all
  double range = 0;                        // counts of the brightest colour; 0: those of the data set
};

// Frames of an episode or of all, counted from 0. All figures have one colour scale.
class FrameFigures {
 public:
  // Reads in child processes. Throws Error(kInput) if there are no such frames, and what DatasetReader throws; so do the functions below.
  explicit FrameFigures(FrameSelection selection);

  std::uint64_t numFrames() const { return end_ - begin_; }

  // s, of all frames.
  std::vector<double> times() const;

  // Draws frames on one page.
  Canvas figureOf(const std::vector<std::uint64_t>& frames);

  // Draws one frame. Reads those that follow as well, for the next calls.
  Canvas pictureOf(std::uint64_t frame);

  // For figures of other forms: one frame, what all have in common, and the values below.
  TactilePanel panelOf(std::uint64_t frame);
  const FigureOptions& options();
  const std::string& directory() const { return selection_.directory; }
  const Manifest& manifest() const { return reader_.manifest(); }

  // The sensor where columns are grouped by sensor; empty for a data set of one sensor.
  std::string sensorName() const;

  // Rows of any column of all frames, (num_frames x width), by its whole name. Empty if there is no such column.
  std::vector<double> allOf(const std::string& name) const;

  // Rows of a column of all frames, (num_frames x width); `name`: below data/, of a sensor's own column below its group. Empty if there is
  // no such column, or its rows have another shape.
  std::vector<double> valuesOf(const std::string& name, std::size_t width) const;

  // rad, of the edge that is measured in each frame, (num_frames); NaN where it is undefined. Empty if it is not recorded.
  std::vector<double> edgeAngles() const;

  // Index in the scene of the object of the episode; none if it is not recorded, or several episodes are selected.
  std::optional<std::size_t> objectIndex() const;

 private:
  void read(std::uint64_t first, std::uint64_t count);
  std::vector<double> row(const std::string& name, std::uint64_t frame) const;
  std::vector<double> row(const std::string& name, std::uint64_t frame, std::size_t length) const;
  TactilePanel imageOf(std::uint64_t frame) const;
  void showThreeAxes(TactilePanel& panel, std::uint64_t frame) const;
  std::optional<ContactAxes> axesOf(const TactilePanel& panel, std::uint64_t frame) const;
  std::string forceText(const TactilePanel& panel, std::uint64_t frame) const;
  std::string captionOf(const TactilePanel& panel, std::uint64_t frame) const;
  std::string titleOf(std::uint64_t frame);
  TactilePanel describe(std::uint64_t frame);
  double range() const;

  FrameSelection selection_;
  DatasetReader reader_;
  std::string group_;  // begin of the names of the sensor's columns
  const Column& image_;
  std::string shown_;                                   // the column that panels show
  double least_shear_;                                  // counts, of the shortest arrow
  std::vector<std::uint64_t> episodes_;                 // numbers of those that are there
  std::array<double, 2> pitch_{0, 0};                   // m, of the grid of a sensor in a group; 0: unknown
  std::vector<TaxelOutline> outlines_;                  // empty unless the sensor is a list of taxels
  std::uint64_t begin_ = 0, end_ = 0;                   // frames of the data set
  std::uint64_t first_ = 0, count_ = 0;                 // frames of columns_
  std::map<std::string, std::vector<double>> columns_;  // rows of the frames, one after the other
  std::uint64_t object_row_ = ~std::uint64_t{0};        // episode to which object_ belongs
  std::string object_;
  std::optional<FigureOptions> options_;
};

}  // namespace taxelsim::figures
