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

inline constexpr const char* kTactileImage = "data/tactile_image";

// The column of that name, or none.
const Column* findColumn(const Manifest& manifest, const std::string& name);

// Outlines of the taxels of a list; empty for other sensors.
std::vector<figures::TaxelOutline> outlinesOf(const Manifest& manifest);

// Panels of frames that follow each other. For several sensors, of the first one.
class FramePanels {
 public:
  // Reads what the panels show of frames [first, first + count). `reader` must outlive the object. `outlines`: outlinesOf() its manifest.
  FramePanels(const DatasetReader& reader, std::vector<figures::TaxelOutline> outlines, std::uint64_t first, std::uint64_t count);

  // Image, principal axes, and a caption with time, force and angle as far as they are recorded. Without a title.
  figures::TactilePanel panelOf(std::uint64_t frame) const;

 private:
  std::vector<double> row(const std::string& name, std::uint64_t frame) const;
  std::vector<double> row(const std::string& name, std::uint64_t frame, std::size_t length) const;
  figures::TactilePanel imageOf(std::uint64_t frame) const;
  std::optional<figures::ContactAxes> axesOf(const figures::TactilePanel& panel, std::uint64_t frame) const;
  std::string forceText(const figures::TactilePanel& panel, std::uint64_t frame) const;
  std::string captionOf(const figures::TactilePanel& panel, std::uint64_t frame) const;

  const Manifest& manifest_;
  std::vector<figures::TaxelOutline> outlines_;
  std::uint64_t first_, count_;
  std::map<std::string, std::vector<double>> columns_;  // rows of the frames, one after the other
};

}  // namespace taxelsim::cli
