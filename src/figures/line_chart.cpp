#include "figures/line_chart.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "taxelsim/error.h"

namespace taxelsim::figures {
namespace {

// Lengths in points.
constexpr PlotSize kChartPlot{.width = 340, .height = 190};
constexpr double kTitleRoom = 18, kLegendLine = 15, kLabelRoom = 20, kMarkRoom = 11;
constexpr double kColumnGap = 30, kRowGap = 24;
constexpr double kSample = 18;  // length of a line in the legend
constexpr double kEntryGap = 16;

// A legend entry: symbol and name.
struct Entry {
  enum class Kind { kLine, kDashed, kPoints, kBand } kind;
  Colour colour;
  std::string name;
};

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
    if (lines.empty() || used + width - kEntryGap > kChartPlot.width + kTickText) {
      lines.emplace_back();
      used = 0;
    }
    used += width;
    lines.back().push_back(std::move(entry));
  }
  return lines;
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
        cairo_set_line_width(canvas, kCurve);
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
  const double width = 2 * kMargin + num_cols * (kTickText + kChartPlot.width + kColumnGap) - kColumnGap;
  double height = heading + kMargin - kRowGap;
  for (const double head : heads) height += head + kChartPlot.height + kPlotFoot + kRowGap;
  if (std::max(width, height) * kPixelsPerPoint > kLargestSide)
    throw Error(ErrorKind::kInput, fmt::format("{} panels do not fit into one picture: reduce their number", count));

  const Canvas canvas(width, height);
  canvas.heading(options.title, options.subtitle, width);
  double top = heading;
  for (int p = 0; p < count; ++p) {
    const LinePanel& panel = panels[static_cast<std::size_t>(p)];
    const double head = heads[static_cast<std::size_t>(p / num_cols)];
    const double left = kMargin + p % num_cols * (kTickText + kChartPlot.width + kColumnGap);
    cairo_save(canvas);
    cairo_translate(canvas, left, top);
    canvas.colour(kInk);
    canvas.font(kBody, true);
    canvas.text(0, kBody - 3, panel.title, 0, kTickText + kChartPlot.width);
    cairo_translate(canvas, 0, (panel.title.empty() ? 0 : kTitleRoom) + kSmall / 2);
    drawLegend(canvas, legends[static_cast<std::size_t>(p)]);
    cairo_restore(canvas);

    cairo_save(canvas);
    cairo_translate(canvas, left + kTickText, top + head);
    canvas.colour(kGrey);
    canvas.font(kSmall);
    canvas.text(-kTickText, -11 - (panel.marks.empty() ? 0 : kMarkRoom), panel.y_label, 0, kTickText + kChartPlot.width);
    drawPlot(canvas, panel, kChartPlot);
    cairo_restore(canvas);
    if (p % num_cols == num_cols - 1) top += head + kChartPlot.height + kPlotFoot + kRowGap;
  }
  canvas.save(file);
}

}  // namespace taxelsim::figures
