// One plot with linear axes: curves, levels, marks. Charts of several plots are in line_chart.h.
#pragma once

#include <array>
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

// Colours of successive series, distinguishable with colour vision deficiency.
Colour seriesColour(std::size_t number);

// Colours of the panel's series.
std::vector<Colour> coloursOf(const LinePanel& panel);

// Lengths in points.
inline constexpr double kTickText = 46;             // left of a plot, for the numbers at its ticks
inline constexpr double kPlotFoot = 34;             // under a plot, for the numbers and the label of x
inline constexpr double kCurve = 1.8, kThin = 0.8;  // widths of lines
inline constexpr double kBandAlpha = 0.13;

// Size of a plot without its numbers and labels, points.
struct PlotSize {
  double width = 0, height = 0;
};

// Draws the plot with its axes and the label of x, but neither title, label of y nor legend; the origin is its upper left corner. Throws
// Error(kInput) for an empty range.
void drawPlot(const Canvas& canvas, const LinePanel& panel, const PlotSize& size);

// Parts of curves, which legends show as well.
void setDashes(const Canvas& canvas, bool dashed);
void drawDot(const Canvas& canvas, double x, double y, const Colour& colour);

}  // namespace taxelsim::figures
