// Curves in a picture: panels with axes, beside each other. Not a plotting library: linear axes and what our own figures need, and nothing
// here knows where the values come from.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "figures/canvas.h"

namespace taxelsim::cli {

enum class LineStyle { kLine, kDashed, kPoints };

// A curve through (x, y). A value that is not finite breaks it.
struct LineSeries {
  std::string name;       // in the legend; empty: not there
  std::vector<double> x;  // (num_points)
  std::vector<double> y;  // (num_points)
  LineStyle style = LineStyle::kLine;
  std::optional<Colour> colour{};  // by default the next of seriesColour()
  // Shaded between them, an interval around the curve; both empty or both (num_points).
  std::vector<double> low{}, high{};
};

// A level of y all along x, or what lies between two of them.
struct LineLevel {
  double y = 0;
  std::string name{};  // in the legend; empty: not there
};
struct LineBand {
  double low = 0, high = 0;
  std::string name{};
};

// A place on x, as a thin line with a word at its head.
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
  // From and to. By default x goes as far as the values, y to the ticks around them, reference and band included.
  std::optional<std::array<double, 2>> x_range{}, y_range{};
  bool equal_axes = false;  // a unit of x is as long as one of y
};

struct LineChartOptions {
  std::string title{};
  std::string subtitle{};
  int num_columns = 0;  // of panels; 0: two, or one of a single panel
};

// The colours that series take in turn: told apart by the colour-blind, and in this order on paper too.
Colour seriesColour(std::size_t number);

// Writes a PNG of all panels. Throws Error(kIo) when the file cannot be written, Error(kInput) when there is no panel, a series' arrays
// differ in length, a range is empty, or the picture would be larger than Cairo can make.
void writeLineChart(const std::filesystem::path& file, const std::vector<LinePanel>& panels, const LineChartOptions& options);

}  // namespace taxelsim::cli
