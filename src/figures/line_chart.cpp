#include "figures/line_chart.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "taxelsim/error.h"

namespace taxelsim::figures {
namespace {

// Lengths in points.
constexpr double kPlotWidth = 340, kPlotHeight = 190;
constexpr double kTickText = 46;  // left of a plot, for the numbers at its ticks
constexpr double kFoot = 34;      // under a plot, for the numbers and the label of x
constexpr double kTitleRoom = 18, kLegendLine = 15, kLabelRoom = 20, kMarkRoom = 11;
constexpr double kColumnGap = 30, kRowGap = 24;
constexpr double kStroke = 1.8, kThin = 0.8, kDot = 2.4;  // widths of lines, radius of a point
constexpr double kSample = 18;                            // length of a line in the legend
constexpr double kEntryGap = 16;
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

  double across(double value) const { return (value - x.low) / x.length() * kPlotWidth; }
  double down(double value) const { return (y.high - value) / y.length() * kPlotHeight; }
};

Axes axesOf(const LinePanel& panel) {
  Axes axes{xRange(panel), yRange(panel)};
  if (!panel.equal_axes) return axes;
  const double unit = std::max(axes.x.length() / kPlotWidth, axes.y.length() / kPlotHeight);
  const auto grown = [](const Interval& interval, double length) {
    const double middle = (interval.low + interval.high) / 2;
    return Interval{middle - length / 2, middle + length / 2};
  };
  return {grown(axes.x, unit * kPlotWidth), grown(axes.y, unit * kPlotHeight)};
}

// A legend entry: symbol and name.
struct Entry {
  enum class Kind { kLine, kDashed, kPoints, kBand } kind;
  Colour colour;
  std::string name;
};

constexpr double kBandAlpha = 0.13, kIntervalAlpha = 0.18;

// Colours of the panel's series.
std::vector<Colour> coloursOf(const LinePanel& panel) {
  std::vector<Colour> colours;
  std::size_t next = 0;
  for (const LineSeries& series : panel.series) colours.push_back(series.colour ? *series.colour : seriesColour(next++));
  return colours;
}

std::vector<Entry> entriesOf(const LinePanel& panel) {
  std::vector<Entry> entries;
  const std::vector<Colour> colours = coloursOf(panel);
  for (std::size_t s = 0; s < panel.series.size(); ++s) {
    const LineSeries& series = panel.series[s];
    if (series.name.empty()) continue;
    const Entry::Kind kind = series.style == LineStyle::kLine     ? Entry::Kind::kLine
                             : series.style == LineStyle::kDashed ? Entry::Kind::kDashed
                                                                  : Entry::Kind::kPoints;
    entries.push_back({kind, colours[s], series.name});
  }
  if (panel.reference && !panel.reference->name.empty()) entries.push_back({Entry::Kind::kLine, kGreen, panel.reference->name});
  if (panel.band && !panel.band->name.empty()) entries.push_back({Entry::Kind::kBand, kGreen, panel.band->name});
  return entries;
}

// Lines of the legend, each with as many entries as fit above a plot.
std::vector<std::vector<Entry>> legendOf(const Canvas& canvas, const LinePanel& panel) {
  canvas.font(kSmall);
  std::vector<std::vector<Entry>> lines;
  double used = 0;
  for (Entry& entry : entriesOf(panel)) {
    const double width = kSample + 5 + canvas.widthOf(entry.name) + kEntryGap;
    if (lines.empty() || used + width - kEntryGap > kPlotWidth + kTickText) {
      lines.emplace_back();
      used = 0;
    }
    used += width;
    lines.back().push_back(std::move(entry));
  }
  return lines;
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

void drawLegend(const Canvas& canvas, const std::vector<std::vector<Entry>>& lines) {
  canvas.font(kSmall);
  double y = 0;
  for (const std::vector<Entry>& line : lines) {
    double x = 0;
    for (const Entry& entry : line) {
      canvas.colour(entry.colour);
      if (entry.kind == Entry::Kind::kPoints) {
        drawDot(canvas, x + kSample / 2, y, entry.colour);
      } else if (entry.kind == Entry::Kind::kBand) {
        canvas.colour(entry.colour, 2 * kBandAlpha);
        cairo_rectangle(canvas, x, y - 4, kSample, 8);
        cairo_fill(canvas);
      } else {
        setDashes(canvas, entry.kind == Entry::Kind::kDashed);
        cairo_set_line_width(canvas, kStroke);
        cairo_move_to(canvas, x, y);
        cairo_line_to(canvas, x + kSample, y);
        cairo_stroke(canvas);
        setDashes(canvas, false);
      }
      canvas.colour(kGrey);
      canvas.text(x + kSample + 5, y + 0.36 * kSmall, entry.name);
      x += kSample + 5 + canvas.widthOf(entry.name) + kEntryGap;
    }
    y += kLegendLine;
  }
}

// Grid, ticks and labels; the origin is the plot's upper left corner.
void drawAxes(const Canvas& canvas, const LinePanel& panel, const Axes& axes) {
  canvas.font(kSmall);
  cairo_set_line_width(canvas, kThin);
  for (const double tick : ticksOf(axes.y.low, axes.y.high)) {
    const double y = axes.down(tick);
    canvas.colour(kGap);
    cairo_move_to(canvas, 0, y);
    cairo_line_to(canvas, kPlotWidth, y);
    cairo_stroke(canvas);
    canvas.colour(kInk);
    canvas.text(-7, y + 0.36 * kSmall, fmt::format("{:g}", tick), 1, kTickText - 10);
  }
  for (const double tick : ticksOf(axes.x.low, axes.x.high)) {
    const double x = axes.across(tick);
    canvas.colour(kGrey);
    cairo_move_to(canvas, x, kPlotHeight);
    cairo_line_to(canvas, x, kPlotHeight + 4);
    cairo_stroke(canvas);
    canvas.colour(kInk);
    canvas.text(x, kPlotHeight + 7 + kSmall, fmt::format("{:g}", tick), 0.5);
  }
  canvas.colour(kGrey);
  cairo_move_to(canvas, 0, kPlotHeight);
  cairo_line_to(canvas, kPlotWidth, kPlotHeight);
  cairo_stroke(canvas);
  canvas.text(kPlotWidth / 2, kPlotHeight + kFoot - 2, panel.x_label, 0.5, kPlotWidth);
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
    cairo_set_line_width(canvas, kStroke);
    setDashes(canvas, series.style == LineStyle::kDashed);
    cairo_stroke(canvas);
    setDashes(canvas, false);
  });
}

void drawLevels(const Canvas& canvas, const LinePanel& panel, const Axes& axes) {
  if (panel.band) {
    canvas.colour(kGreen, kBandAlpha);
    const double top = axes.down(panel.band->high);
    cairo_rectangle(canvas, 0, top, kPlotWidth, axes.down(panel.band->low) - top);
    cairo_fill(canvas);
  }
  if (panel.reference) {
    canvas.colour(kGreen);
    cairo_set_line_width(canvas, kStroke);
    cairo_move_to(canvas, 0, axes.down(panel.reference->y));
    cairo_line_to(canvas, kPlotWidth, axes.down(panel.reference->y));
    cairo_stroke(canvas);
  }
}

void drawMarks(const Canvas& canvas, const LinePanel& panel, const Axes& axes) {
  canvas.font(kSmall);
  cairo_select_font_face(canvas, kMarkFont, CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  for (const LineMark& mark : panel.marks) {
    const double x = axes.across(mark.x);
    if (!(x >= -kThin && x <= kPlotWidth + kThin)) continue;
    canvas.colour(kGrey);
    cairo_set_line_width(canvas, kThin);
    setDashes(canvas, true);
    cairo_move_to(canvas, x, 0);
    cairo_line_to(canvas, x, kPlotHeight);
    cairo_stroke(canvas);
    setDashes(canvas, false);
    canvas.text(x, -4, mark.name, 0.5);
  }
}

// The plot with its axes; the origin is its upper left corner.
void drawPlot(const Canvas& canvas, const LinePanel& panel) {
  const Axes axes = axesOf(panel);
  const std::vector<Colour> colours = coloursOf(panel);
  drawAxes(canvas, panel, axes);
  drawMarks(canvas, panel, axes);
  cairo_save(canvas);
  cairo_rectangle(canvas, -kDot, -kDot, kPlotWidth + 2 * kDot, kPlotHeight + 2 * kDot);
  cairo_clip(canvas);
  drawLevels(canvas, panel, axes);
  for (std::size_t s = 0; s < panel.series.size(); ++s) drawInterval(canvas, panel.series[s], axes, colours[s]);
  for (std::size_t s = 0; s < panel.series.size(); ++s) drawSeries(canvas, panel.series[s], axes, colours[s]);
  cairo_restore(canvas);
}

void checkPanels(const std::vector<LinePanel>& panels) {
  if (panels.empty()) throw Error(ErrorKind::kInput, "there is no curve to draw");
  for (const LinePanel& panel : panels) {
    for (const LineSeries& series : panel.series) {
      const bool has_interval = !series.low.empty() || !series.high.empty();
      if (series.y.size() == series.x.size() &&
          (!has_interval || (series.low.size() == series.x.size() && series.high.size() == series.x.size()))) {
        continue;
      }
      throw Error(ErrorKind::kInput, fmt::format("curve {}: {} values of x, {} of y, {} and {} of its interval", series.name,
                                                 series.x.size(), series.y.size(), series.low.size(), series.high.size()));
    }
  }
}

}  // namespace

Colour seriesColour(std::size_t number) {
  return kSeries[number % kSeries.size()];
}

LineSeries cumulativeShare(const std::string& name, std::vector<double> values) {
  const double all = static_cast<double>(values.size());
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  std::sort(values.begin(), values.end());
  LineSeries series{.name = name, .x = {}, .y = {}};
  for (std::size_t k = 0; k < values.size(); ++k) {
    for (const double count : {static_cast<double>(k), static_cast<double>(k + 1)}) {
      series.x.push_back(values[k]);
      series.y.push_back(100 * count / all);
    }
  }
  return series;
}

void writeLineChart(const std::filesystem::path& file, const std::vector<LinePanel>& panels, const LineChartOptions& options) {
  checkPanels(panels);
  const int count = static_cast<int>(panels.size());
  const int num_cols = std::clamp(options.num_columns > 0 ? options.num_columns : 2, 1, count);
  const int num_rows = (count + num_cols - 1) / num_cols;

  // All panels of a row reserve the height of the longest legend, so that their plots are aligned. Measuring text needs a canvas.
  const Canvas ruler(1, 1);
  std::vector<std::vector<std::vector<Entry>>> legends;
  std::vector<double> heads(static_cast<std::size_t>(num_rows), 0);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    legends.push_back(legendOf(ruler, panels[p]));
    double head = (panels[p].title.empty() ? 0 : kTitleRoom) + static_cast<double>(legends[p].size()) * kLegendLine;
    head += (panels[p].y_label.empty() ? 0 : kLabelRoom) + (panels[p].marks.empty() ? 0 : kMarkRoom) + 4;
    double& of_row = heads[p / static_cast<std::size_t>(num_cols)];
    of_row = std::max(of_row, head);
  }
  const double heading = headingRoom(options.subtitle);
  const double width = 2 * kMargin + num_cols * (kTickText + kPlotWidth + kColumnGap) - kColumnGap;
  double height = heading + kMargin - kRowGap;
  for (const double head : heads) height += head + kPlotHeight + kFoot + kRowGap;
  if (std::max(width, height) * kPixelsPerPoint > kLargestSide)
    throw Error(ErrorKind::kInput, fmt::format("{} panels do not fit into one picture: reduce their number", count));

  const Canvas canvas(width, height);
  canvas.heading(options.title, options.subtitle, width);
  double top = heading;
  for (int p = 0; p < count; ++p) {
    const LinePanel& panel = panels[static_cast<std::size_t>(p)];
    const double head = heads[static_cast<std::size_t>(p / num_cols)];
    const double left = kMargin + p % num_cols * (kTickText + kPlotWidth + kColumnGap);
    cairo_save(canvas);
    cairo_translate(canvas, left, top);
    canvas.colour(kInk);
    canvas.font(kBody, true);
    canvas.text(0, kBody - 3, panel.title, 0, kTickText + kPlotWidth);
    cairo_translate(canvas, 0, (panel.title.empty() ? 0 : kTitleRoom) + kSmall / 2);
    drawLegend(canvas, legends[static_cast<std::size_t>(p)]);
    cairo_restore(canvas);

    cairo_save(canvas);
    cairo_translate(canvas, left + kTickText, top + head);
    canvas.colour(kGrey);
    canvas.font(kSmall);
    canvas.text(-kTickText, -11 - (panel.marks.empty() ? 0 : kMarkRoom), panel.y_label, 0, kTickText + kPlotWidth);
    drawPlot(canvas, panel);
    cairo_restore(canvas);
    if (p % num_cols == num_cols - 1) top += head + kPlotHeight + kFoot + kRowGap;
  }
  canvas.save(file);
}

}  // namespace taxelsim::figures
