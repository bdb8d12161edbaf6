#include "figures/line_plot.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "taxelsim/error.h"

namespace taxelsim::figures {
namespace {

constexpr double kDot = 2.4;  // points, radius
constexpr double kIntervalAlpha = 0.18;
constexpr double kLeastRange = 1e-12;  // relative to the values: smaller ranges count as a single value

// Palette of Okabe and Ito (2008) without yellow, which is faint on white. Green comes late, because references are green.
constexpr std::array<Colour, 7> kSeries{rgb(0x0072b2), rgb(0xd55e00), rgb(0xcc79a7), rgb(0xe69f00), rgb(0x56b4e9), rgb(0x009e73), kInk};
constexpr const char* kMarkFont = "DejaVu Serif";  // Roman numerals need serifs

struct Interval {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void include(const std::vector<double>& values) {
    for (const double value : values) include(value);
  }
  double length() const { return high - low; }
};

// Widens an empty interval to [0, 1], and a single value symmetrically.
Interval widened(Interval interval) {
  if (!(interval.high >= interval.low)) return {0, 1};
  const double size = std::max(std::abs(interval.low), std::abs(interval.high));
  if (interval.length() > kLeastRange * size) return interval;
  const double half = size > 0 ? 0.1 * size : 0.5;
  return {interval.low - half, interval.high + half};
}

Interval given(const std::array<double, 2>& range) {
  if (!(range[1] > range[0] && std::isfinite(range[1] - range[0]))) {
    throw Error(ErrorKind::kInput, fmt::format("an axis from {} to {} cannot be drawn", range[0], range[1]));
  }
  return {range[0], range[1]};
}

Interval xRange(const LinePanel& panel) {
  if (panel.x_range) return given(*panel.x_range);
  Interval x;
  for (const LineSeries& series : panel.series) x.include(series.x);
  return widened(x);
}

Interval yRange(const LinePanel& panel) {
  if (panel.y_range) return given(*panel.y_range);
  Interval y;
  for (const LineSeries& series : panel.series) {
    y.include(series.y);
    y.include(series.low);
    y.include(series.high);
  }
  if (panel.reference) y.include(panel.reference->y);
  if (panel.band) y.include(panel.band->low), y.include(panel.band->high);
  y = widened(y);
  const double step = tickStep(y.length());
  return {std::floor(y.low / step) * step, std::ceil(y.high / step) * step};
}

// Maps values to points; y points up.
struct Axes {
  Interval x, y;
  PlotSize size;

  double across(double value) const { return (value - x.low) / x.length() * size.width; }
  double down(double value) const { return (y.high - value) / y.length() * size.height; }
};

Axes axesOf(const LinePanel& panel, const PlotSize& size) {
  Axes axes{xRange(panel), yRange(panel), size};
  if (!panel.equal_axes) return axes;
  const double unit = std::max(axes.x.length() / size.width, axes.y.length() / size.height);
  const auto grown = [](const Interval& interval, double length) {
    const double middle = (interval.low + interval.high) / 2;
    return Interval{middle - length / 2, middle + length / 2};
  };
  return {grown(axes.x, unit * size.width), grown(axes.y, unit * size.height), size};
}

// Grid, ticks and labels; the origin is the plot's upper left corner.
void drawAxes(const Canvas& canvas, const LinePanel& panel, const Axes& axes) {
  canvas.font(kSmall);
  cairo_set_line_width(canvas, kThin);
  for (const double tick : ticksOf(axes.y.low, axes.y.high)) {
    const double y = axes.down(tick);
    canvas.colour(kGap);
    cairo_move_to(canvas, 0, y);
    cairo_line_to(canvas, axes.size.width, y);
    cairo_stroke(canvas);
    canvas.colour(kInk);
    canvas.text(-7, y + 0.36 * kSmall, fmt::format("{:g}", tick), 1, kTickText - 10);
  }
  for (const double tick : ticksOf(axes.x.low, axes.x.high)) {
    const double x = axes.across(tick);
    canvas.colour(kGrey);
    cairo_move_to(canvas, x, axes.size.height);
    cairo_line_to(canvas, x, axes.size.height + 4);
    cairo_stroke(canvas);
    canvas.colour(kInk);
    canvas.text(x, axes.size.height + 7 + kSmall, fmt::format("{:g}", tick), 0.5);
  }
  canvas.colour(kGrey);
  cairo_move_to(canvas, 0, axes.size.height);
  cairo_line_to(canvas, axes.size.width, axes.size.height);
  cairo_stroke(canvas);
  canvas.text(axes.size.width / 2, axes.size.height + kPlotFoot - 2, panel.x_label, 0.5, axes.size.width);
}

// Calls function(begin, end) for each run of points with finite values.
template <typename Function>
void eachStretch(const LineSeries& series, const std::vector<double>& y, Function function) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= series.x.size(); ++i) {
    if (i < series.x.size() && std::isfinite(series.x[i]) && std::isfinite(y[i])) continue;
    if (i > begin) function(begin, i);
    begin = i + 1;
  }
}

void drawInterval(const Canvas& canvas, const LineSeries& series, const Axes& axes, const Colour& colour) {
  if (series.low.empty()) return;
  std::vector<double> width;
  for (std::size_t i = 0; i < series.low.size(); ++i) width.push_back(series.high[i] - series.low[i]);
  canvas.colour(colour, kIntervalAlpha);
  eachStretch(series, width, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) cairo_line_to(canvas, axes.across(series.x[i]), axes.down(series.low[i]));
    for (std::size_t i = end; i > begin; --i) cairo_line_to(canvas, axes.across(series.x[i - 1]), axes.down(series.high[i - 1]));
    cairo_close_path(canvas);
    cairo_fill(canvas);
  });
}

void drawSeries(const Canvas& canvas, const LineSeries& series, const Axes& axes, const Colour& colour) {
  eachStretch(series, series.y, [&](std::size_t begin, std::size_t end) {
    if (series.style == LineStyle::kPoints) {
      for (std::size_t i = begin; i < end; ++i) drawDot(canvas, axes.across(series.x[i]), axes.down(series.y[i]), colour);
      return;
    }
    for (std::size_t i = begin; i < end; ++i) cairo_line_to(canvas, axes.across(series.x[i]), axes.down(series.y[i]));
    canvas.colour(colour);
    cairo_set_line_width(canvas, kCurve);
    setDashes(canvas, series.style == LineStyle::kDashed);
    cairo_stroke(canvas);
    setDashes(canvas, false);
  });
}

void drawLevels(const Canvas& canvas, const LinePanel& panel, const Axes& axes) {
  if (panel.band) {
    canvas.colour(kGreen, kBandAlpha);
    const double top = axes.down(panel.band->high);
    cairo_rectangle(canvas, 0, top, axes.size.width, axes.down(panel.band->low) - top);
    cairo_fill(canvas);
  }
  if (panel.reference) {
    canvas.colour(kGreen);
    cairo_set_line_width(canvas, kCurve);
    cairo_move_to(canvas, 0, axes.down(panel.reference->y));
    cairo_line_to(canvas, axes.size.width, axes.down(panel.reference->y));
    cairo_stroke(canvas);
  }
}

void drawMarks(const Canvas& canvas, const LinePanel& panel, const Axes& axes) {
  canvas.font(kSmall);
  cairo_select_font_face(canvas, kMarkFont, CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  for (const LineMark& mark : panel.marks) {
    const double x = axes.across(mark.x);
    if (!(x >= -kThin && x <= axes.size.width + kThin)) continue;
    canvas.colour(kGrey);
    cairo_set_line_width(canvas, kThin);
    setDashes(canvas, true);
    cairo_move_to(canvas, x, 0);
    cairo_line_to(canvas, x, axes.size.height);
    cairo_stroke(canvas);
    setDashes(canvas, false);
    canvas.text(x, -4, mark.name, 0.5);
  }
}

}  // namespace

Colour seriesColour(std::size_t number) {
  return kSeries[number % kSeries.size()];
}

std::vector<Colour> coloursOf(const LinePanel& panel) {
  std::vector<Colour> colours;
  std::size_t next = 0;
  for (const LineSeries& series : panel.series) colours.push_back(series.colour ? *series.colour : seriesColour(next++));
  return colours;
}

void setDashes(const Canvas& canvas, bool dashed) {
  static constexpr double kDashes[2] = {5, 4};
  cairo_set_dash(canvas, kDashes, dashed ? 2 : 0, 0);
}

void drawDot(const Canvas& canvas, double x, double y, const Colour& colour) {
  cairo_arc(canvas, x, y, kDot, 0, 2 * std::numbers::pi);
  canvas.colour(colour);
  cairo_fill_preserve(canvas);
  canvas.colour(kPaper);
  cairo_set_line_width(canvas, kThin);
  cairo_stroke(canvas);
}

void drawPlot(const Canvas& canvas, const LinePanel& panel, const PlotSize& size) {
  const Axes axes = axesOf(panel, size);
  const std::vector<Colour> colours = coloursOf(panel);
  drawAxes(canvas, panel, axes);
  drawMarks(canvas, panel, axes);
  cairo_save(canvas);
  cairo_rectangle(canvas, -kDot, -kDot, size.width + 2 * kDot, size.height + 2 * kDot);
  cairo_clip(canvas);
  drawLevels(canvas, panel, axes);
  for (std::size_t s = 0; s < panel.series.size(); ++s) drawInterval(canvas, panel.series[s], axes, colours[s]);
  for (std::size_t s = 0; s < panel.series.size(); ++s) drawSeries(canvas, panel.series[s], axes, colours[s]);
  cairo_restore(canvas);
}

}  // namespace taxelsim::figures
