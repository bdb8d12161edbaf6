// Frames of a data set as panels of a figure.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "figures/tactile_figure.h"
#include "figures/taxel_chart.h"
#include "taxelsim/dataset.h"

namespace taxelsim::cli {

// Group of the columns of one sensor, unless a data set has one for each: "data/NAME/".
inline constexpr const char* kData = "data/";
inline constexpr const char* kTactileImage = "tactile_image";  // below its group
inline constexpr const char* kTaxelCounts = "taxel_counts";    // as above, of three-axis taxels

// The column of that name, or none.
const Column* findColumn(const Manifest& manifest, const std::string& name);

// Outlines of the taxels of a list; empty for other sensors.
std::vector<figures::TaxelOutline> outlinesOf(const Manifest& manifest);

// The group of the sensor of that name, or of the first sensor for an empty name. Throws Error(kInput), which begins with `directory`, if
// there is no image.
std::string imageGroup(const Manifest& manifest, const std::string& sensor, const std::string& directory);

// The column that panels of that group show: the counts of three-axis taxels where they are recorded, else the tactile image.
std::string shownColumn(const Manifest& manifest, const std::string& group);

// Panels of frames that follow each other, of the sensor with that group of columns. For several sensors in one group, of the first one.
class FramePanels {
 public:
  // Reads what the panels show of frames [first, first + count). `reader` must outlive the object. `outlines`: outlinesOf() its manifest.
  // `least_shear`: counts, of the shortest arrow.
  FramePanels(const DatasetReader& reader, std::string group, std::vector<figures::TaxelOutline> outlines, double least_shear,
              std::uint64_t first, std::uint64_t count);

  // Image, principal axes, and a caption with time, force and angle as far as they are recorded. Without a title. Of three-axis taxels the
  // counts along the normal, with arrows for those along x and y, instead of image and axes.
  figures::TactilePanel panelOf(std::uint64_t frame) const;

 private:
  std::vector<double> row(const std::string& name, std::uint64_t frame) const;
  std::vector<double> row(const std::string& name, std::uint64_t frame, std::size_t length) const;
  figures::TactilePanel imageOf(std::uint64_t frame) const;
  void showThreeAxes(figures::TactilePanel& panel, std::uint64_t frame) const;
  std::optional<figures::ContactAxes> axesOf(const figures::TactilePanel& panel, std::uint64_t frame) const;
  std::string forceText(const figures::TactilePanel& panel, std::uint64_t frame) const;
  std::string captionOf(const figures::TactilePanel& panel, std::uint64_t frame) const;

  const Column& image() const { return *findColumn(manifest_, group_ + kTactileImage); }

  const Manifest& manifest_;
  std::string group_;
  std::vector<figures::TaxelOutline> outlines_;
  double least_shear_;
  std::uint64_t first_, count_;
  std::map<std::string, std::vector<double>> columns_;  // rows of the frames, one after the other
};

}  // namespace taxelsim::cli
