#include "figures/tactile_figure.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "figures/canvas.h"
#include "figures/tactile_panel.h"
#include "taxelsim/error.h"

namespace taxelsim::figures {
namespace {

// Lengths in points.
constexpr double kLeastWidth = 330;  // of all panels, for the title
constexpr double kBarWidth = 14, kBarGap = 22, kBarText = 52, kBarStep = kBarGap + kBarWidth + kBarText;
constexpr double kFigureTitleRoom = 17, kCaptionRoom = 19, kLegendRoom = 24;

void drawColourBar(const Canvas& canvas, double x, double y, double height, const ColourScale& scale, const std::string& unit) {
  cairo_pattern_t* pattern = cairo_pattern_create_linear(0, y + height, 0, y);
  for (std::size_t i = 0; i < scale.colours.size(); ++i) {
    const Colour& colour = scale.colours[i];
    cairo_pattern_add_color_stop_rgb(pattern, static_cast<double>(i) / static_cast<double>(scale.colours.size() - 1), colour.red,
                                     colour.green, colour.blue);
  }
  cairo_rectangle(canvas, x, y, kBarWidth, height);
  cairo_set_source(canvas, pattern);
  cairo_fill(canvas);
  cairo_pattern_destroy(pattern);

  canvas.font(kSmall);
  cairo_set_line_width(canvas, 0.8);
  for (const double tick : ticksOf(scale.low(), scale.top())) {
    const double level = y + height * (scale.top() - tick) / (scale.top() - scale.low());
    canvas.colour(kGrey);
    cairo_move_to(canvas, x + kBarWidth, level);
    cairo_line_to(canvas, x + kBarWidth + 4, level);
    cairo_stroke(canvas);
    canvas.colour(kInk);
    canvas.text(x + kBarWidth + 7, level + 0.36 * kSmall, fmt::format("{:g}", tick));
  }
  canvas.colour(kGrey);
  canvas.text(x, y - 7, unit, 0, kBarWidth + kBarText);
}

// Two small arrows in the directions of x and y.
void drawFrame(const Canvas& canvas, double x, double y) {
  static constexpr double kLength = 15, kHead = 3;
  canvas.colour(kGrey);
  cairo_set_line_width(canvas, 1.1);
  cairo_move_to(canvas, x, y + kLength);
  cairo_line_to(canvas, x, y);
  cairo_line_to(canvas, x + kLength, y);
  cairo_move_to(canvas, x + kLength - kHead, y - kHead);
  cairo_line_to(canvas, x + kLength, y);
  cairo_line_to(canvas, x + kLength - kHead, y + kHead);
  cairo_move_to(canvas, x - kHead, y + kLength - kHead);
  cairo_line_to(canvas, x, y + kLength);
  cairo_line_to(canvas, x + kHead, y + kLength - kHead);
  cairo_stroke(canvas);
  canvas.font(kSmall);
  canvas.text(x + kLength + 4, y + 3.2, "y");
  canvas.text(x + 6, y + kLength + 1.5, "x");
}

using LegendEntry = std::pair<Colour, std::string>;

// Entries for the lines of all panels, without repetition.
std::vector<LegendEntry> legendOf(const std::vector<TactilePanel>& panels) {
  std::vector<LegendEntry> entries;
  if (std::any_of(panels.begin(), panels.end(), [](const TactilePanel& panel) { return panel.neighbours; })) {
    entries = {{kContour, "outline of the contact"}, {kAxis, "principal axes, 2 standard deviations"}};
  }
  for (const TactilePanel& panel : panels) {
    for (const TactileLine& line : panel.lines) {
      const auto has_name = [&](const LegendEntry& entry) { return entry.second == line.name; };
      if (std::none_of(entries.begin(), entries.end(), has_name)) entries.emplace_back(line.colour, line.name);
    }
  }
  return entries;
}

// Below the panels: directions of x and y, and names of lines.
void drawLegend(const Canvas& canvas, double foot, const std::vector<LegendEntry>& entries) {
  drawFrame(canvas, kMargin + 4, foot);
  double x = kMargin + 52;
  canvas.font(kSmall);
  for (const auto& [colour, word] : entries) {
    canvas.colour(colour);
    cairo_set_line_width(canvas, 2.4);
    cairo_move_to(canvas, x, foot + 8);
    cairo_line_to(canvas, x + 16, foot + 8);
    cairo_stroke(canvas);
    canvas.colour(kGrey);
    canvas.text(x + 22, foot + 8 + 0.36 * kSmall, word);
    x += 22 + canvas.widthOf(word) + 18;
  }
}

// Sizes of the page, in points, and the colour scales of all panels.
struct Layout {
  ColourScale counts = valueScale(), differences = differenceScale();
  bool any_signed = false, has_foot = false;  // below the panels: directions of x and y, legend
  std::vector<PanelSize> sizes{};             // (panels)
  std::vector<LegendEntry> legend{};
  int num_cols = 1;
  double widest = 0;  // panel
  double title_room = 0, caption_room = 0, heading = 0;
  double step_x = 0, step_y = 0;  // from panel to panel
  double grid_width = 0, grid_height = 0;
  double width = 0, height = 0;
};

Layout layoutOf(const std::vector<TactilePanel>& panels, const FigureOptions& options) {
  Layout page;
  double highest = 0;
  for (const TactilePanel& panel : panels) {
    double& max = panel.is_signed ? page.differences.max : page.counts.max;
    for (const double value : panel.values) max = std::isfinite(value) ? std::max(max, panel.is_signed ? std::abs(value) : value) : max;
    page.any_signed |= panel.is_signed;
    page.has_foot |= !panel.arrows.empty();
    page.sizes.push_back(sizeOf(panel));
    page.widest = std::max(page.widest, page.sizes.back().width);
    highest = std::max(highest, page.sizes.back().height);
    if (!panel.title.empty()) page.title_room = kFigureTitleRoom;
    if (!panel.caption.empty()) page.caption_room = kCaptionRoom;
  }
  if (options.range > 0) page.counts.max = options.range;
  page.legend = legendOf(panels);
  page.has_foot |= !page.legend.empty();
  page.step_x = page.widest + kGutter;
  page.step_y = page.title_room + highest + page.caption_room + kGutter;
  const auto count = static_cast<int>(panels.size());
  const int wanted =
      options.num_columns > 0 ? options.num_columns : static_cast<int>(std::lround(std::sqrt(count * page.step_y / page.step_x * 4 / 3)));
  page.num_cols = std::clamp(wanted, 1, count);
  const int num_rows = (count + page.num_cols - 1) / page.num_cols;
  page.grid_width = std::max(page.num_cols * page.step_x - kGutter, kLeastWidth);
  page.grid_height = num_rows * page.step_y - kGutter;
  page.heading = headingRoom(options.subtitle);
  page.width = kMargin + page.grid_width + (page.any_signed ? 2 : 1) * kBarStep + kMargin;
  page.height = page.heading + page.grid_height + kMargin + (page.has_foot ? kLegendRoom : 0);
  if (std::max(page.width, page.height) * kPixelsPerPoint > kLargestSide)
    throw Error(ErrorKind::kInput, fmt::format("{} images do not fit into one picture: reduce their number", count));
  return page;
}

}  // namespace

std::optional<ContactAxes> axesOfImage(const TactilePanel& panel) {
  double sum = 0, x = 0, y = 0;
  const auto each = [&panel](auto function) {
    for (int i = 0; i < panel.num_rows; ++i)
      for (int j = 0; j < panel.num_cols; ++j) {
        const double value = panel.values[static_cast<std::size_t>(i) * panel.num_cols + j];
        if (value > 0)
          function(value, (i - 0.5 * (panel.num_rows - 1)) * panel.pitch[0], (j - 0.5 * (panel.num_cols - 1)) * panel.pitch[1]);
      }
  };
  each([&](double value, double px, double py) {
    sum += value;
    x += value * px;
    y += value * py;
  });
  if (!(sum > 0)) return std::nullopt;
  x /= sum;
  y /= sum;
  double xx = 0, xy = 0, yy = 0;
  each([&](double value, double px, double py) {
    xx += value * (px - x) * (px - x) / sum;
    xy += value * (px - x) * (py - y) / sum;
    yy += value * (py - y) * (py - y) / sum;
  });
  const double mean = (xx + yy) / 2, spread = std::hypot((xx - yy) / 2, xy);
  return ContactAxes{{x, y}, 0.5 * std::atan2(2 * xy, xx - yy), {mean + spread, std::max(mean - spread, 0.0)}};
}

Canvas drawTactileFigure(const std::vector<TactilePanel>& panels, const FigureOptions& options) {
  if (panels.empty()) throw Error(ErrorKind::kInput, "there is no tactile image to draw");
  const Layout page = layoutOf(panels, options);
  Canvas canvas(page.width, page.height);
  canvas.heading(options.title, options.subtitle, page.width);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const TactilePanel& panel = panels[p];
    const std::size_t row = p / static_cast<std::size_t>(page.num_cols), col = p % static_cast<std::size_t>(page.num_cols);
    cairo_save(canvas);
    cairo_translate(canvas, kMargin + static_cast<double>(col) * page.step_x,
                    page.heading + static_cast<double>(row) * page.step_y + page.title_room);
    canvas.colour(kInk);
    canvas.font(kBody, true);
    canvas.text(0, -6, panel.title, 0, page.widest);
    drawPanel(canvas, panel, page.sizes[p], panel.is_signed ? page.differences : page.counts);
    canvas.colour(kGrey);
    canvas.font(kSmall);
    canvas.text(0, page.sizes[p].height + kSmall + 5, panel.caption, 0, page.widest);
    cairo_restore(canvas);
  }

  const double bar_left = kMargin + page.grid_width + kBarGap, bar_top = page.heading + page.title_room;
  const double bar_height = std::min(page.grid_height - page.title_room - page.caption_room, 420.0);
  drawColourBar(canvas, bar_left, bar_top, bar_height, page.counts, options.unit);
  if (page.any_signed) drawColourBar(canvas, bar_left + kBarStep, bar_top, bar_height, page.differences, "difference");
  if (page.has_foot) drawLegend(canvas, page.heading + page.grid_height + 20, page.legend);
  return canvas;
}

void writeTactileFigure(const std::filesystem::path& file, const std::vector<TactilePanel>& panels, const FigureOptions& options) {
  drawTactileFigure(panels, options).save(file);
}

}  // namespace taxelsim::figures
