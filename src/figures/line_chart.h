// Charts of curves: panels with linear axes.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "figures/canvas.h"

namespace taxelsim::figures {

enum class LineStyle { kLine, kDashed, kPoints };

// A curve through (x, y), interrupted at values that are not finite.
struct LineSeries {
  std::string name;       // in the legend; empty: no entry
  std::vector<double> x;  // (num_points)
  std::vector<double> y;  // (num_points)
  LineStyle style = LineStyle::kLine;
  std::optional<Colour> colour{};  // default: the next of seriesColour()
  // Bounds of a shaded interval around the curve; both empty or both (num_points).
  std::vector<double> low{}, high{};
};

// A horizontal line, or a shaded band between two levels.
struct LineLevel {
  double y = 0;
  std::string name{};  // in the legend; empty: no entry
};
struct LineBand {
  double low = 0, high = 0;
  std::string name{};
};

// A thin vertical line with a label at the top.
struct LineMark {
  double x = 0;
  std::string name{};
};

struct LinePanel {
  std::string title{};
  std::string x_label{}, y_label{};  // with units: "time, s"
  std::vector<LineSeries> series{};
  std::optional<LineLevel> reference{};
  std::optional<LineBand> band{};
  std::vector<LineMark> marks{};
  // Default: x covers the values; y covers values, reference and band, rounded outwards to ticks.
  std::optional<std::array<double, 2>> x_range{}, y_range{};
  bool equal_axes = false;  // x and y have the same scale
};

struct LineChartOptions {
  std::string title{};
  std::string subtitle{};
  int num_columns = 0;  // of panels; 0: two, or one for a single panel
};

// Colours of successive series, distinguishable with colour vision deficiency.
Colour seriesColour(std::size_t number);

// Cumulative share of episodes (%) over their values; values that are not finite count in the total only.
LineSeries cumulativeShare(const std::string& name, std::vector<double> values);

// Writes a PNG of all panels. Throws Error(kIo) if the file cannot be written; Error(kInput) if there is no panel, the arrays of a series
// differ in length, a range is empty, or the picture is larger than Cairo supports.
void writeLineChart(const std::filesystem::path& file, const std::vector<LinePanel>& panels, const LineChartOptions& options);

}  // namespace taxelsim::figures
