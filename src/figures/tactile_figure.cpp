#include "figures/tactile_figure.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "figures/canvas.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {
namespace {

// Viridis (Smith, van der Walt and Firing, 2015) at eleven even places: lightness rises evenly, and it reads in grey and to the
// colour-blind.
constexpr std::array<Colour, 11> kViridis{rgb(0x440154), rgb(0x482475), rgb(0x414487), rgb(0x355f8d), rgb(0x2a788e), rgb(0x21918c),
                                          rgb(0x22a884), rgb(0x44bf70), rgb(0x7ad151), rgb(0xbddf26), rgb(0xfde725)};
// Of differences: the same lightness on both sides of 0.
constexpr std::array<Colour, 5> kBlueToRed{rgb(0x2b5fa8), rgb(0x8fb3dd), rgb(0xeeeff1), rgb(0xe8a58f), rgb(0xb5372b)};
constexpr Colour kContour = kRed, kAxis = kBlue;
constexpr double kDarkTextFrom = 0.52;  // luminance of a cell from which on dark type reads better than white

// Lengths in points.
constexpr double kSmallestValue = 5.5, kLargestValue = 12;  // sizes of type in cells
constexpr double kPanelLength = 300;                        // longer side of a panel
constexpr double kSmallestPanel = 90;                       // shorter side, which makes room for captions
constexpr double kLeastWidth = 330;                         // of all panels, which makes room for the title
constexpr double kBarWidth = 14, kBarGap = 22, kBarText = 52, kBarStep = kBarGap + kBarWidth + kBarText;
constexpr double kTitleRoom = 17, kCaptionRoom = 19, kLegendRoom = 24;

// A place from 0 to 1 along colours that are evenly apart.
Colour along(std::span<const Colour> colours, double t) {
  const double place = std::clamp(t, 0.0, 1.0) * static_cast<double>(colours.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), colours.size() - 2);
  const double f = place - static_cast<double>(i);
  const auto mix = [f](double from, double to) { return from + f * (to - from); };
  return {mix(colours[i].red, colours[i + 1].red), mix(colours[i].green, colours[i + 1].green), mix(colours[i].blue, colours[i + 1].blue)};
}

// From 0, or of signed values from -max, to max.
struct ColourScale {
  std::span<const Colour> colours;
  double max = 0;
  bool is_signed = false;

  double low() const { return is_signed ? -top() : 0; }
  double top() const { return max > 0 ? max : 1; }
  Colour at(double value) const { return along(colours, (value - low()) / (top() - low())); }
};

double luminance(const Colour& c) {
  return 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue;
}

std::string valueText(double value) {
  return value == std::round(value) && std::abs(value) < 1e6 ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
}

// Sizes of one panel, all from its grid: cells keep the taxels' proportions.
struct PanelSize {
  double cell_width = 0, cell_height = 0;
  double width = 0, height = 0;  // of the grid
};

// Where x and y of all outlines begin and end, m.
struct Extent {
  std::array<double, 2> low, high;
};

Extent extentOf(const std::vector<TaxelOutline>& outlines) {
  Extent extent{outlines.front().front(), outlines.front().front()};
  for (const TaxelOutline& outline : outlines) {
    for (const auto& corner : outline) {
      for (std::size_t axis = 0; axis < 2; ++axis) {
        extent.low[axis] = std::min(extent.low[axis], corner[axis]);
        extent.high[axis] = std::max(extent.high[axis], corner[axis]);
      }
    }
  }
  return extent;
}

// Cells of outlines are as large as the smallest of them, for the values written there.
PanelSize sizeOfOutlines(const std::vector<TaxelOutline>& outlines) {
  const Extent extent = extentOf(outlines);
  const double along_x = extent.high[0] - extent.low[0], along_y = extent.high[1] - extent.low[1];
  double scale = kPanelLength / std::max(along_x, along_y);
  scale *= std::clamp(kSmallestPanel / (scale * std::min(along_x, along_y)), 1.0, 2.0);
  double side = std::max(along_x, along_y);
  for (const TaxelOutline& o : outlines) {
    side = std::min({side, std::hypot(o[1][0] - o[0][0], o[1][1] - o[0][1]), std::hypot(o[3][0] - o[0][0], o[3][1] - o[0][1])});
  }
  return {side * scale, side * scale, along_y * scale, along_x * scale};
}

PanelSize sizeOf(const TactilePanel& panel) {
  if (!panel.outlines.empty()) return sizeOfOutlines(panel.outlines);
  const double along_y = panel.num_cols * panel.pitch[1], along_x = panel.num_rows * panel.pitch[0];
  double scale = kPanelLength / std::max(along_x, along_y);
  // A strip of few taxels grows until its shorter side has room for words, but not past twice the usual length.
  scale *= std::clamp(kSmallestPanel / (scale * std::min(along_x, along_y)), 1.0, 2.0);
  return {panel.pitch[1] * scale, panel.pitch[0] * scale, along_y * scale, along_x * scale};
}

// Calls function(row, column, value, colour) for every cell that has a value.
template <typename Function>
void eachCell(const TactilePanel& panel, const ColourScale& scale, Function function) {
  for (int i = 0; i < panel.num_rows; ++i) {
    for (int j = 0; j < panel.num_cols; ++j) {
      const double value = panel.values[static_cast<std::size_t>(i) * panel.num_cols + j];
      if (std::isfinite(value)) function(i, j, value, scale.at(value));
    }
  }
}

// Calls function(corners in points, value, colour) for every outline that has a value.
template <typename Function>
void eachOutline(const TactilePanel& panel, const PanelSize& size, const ColourScale& colours, Function function) {
  const Extent extent = extentOf(panel.outlines);
  const double scale = size.height / (extent.high[0] - extent.low[0]);
  for (std::size_t t = 0; t < panel.outlines.size(); ++t) {
    if (!std::isfinite(panel.values[t])) continue;
    TaxelOutline corners = panel.outlines[t];
    for (auto& [x, y] : corners) {
      const double down = (x - extent.low[0]) * scale;
      x = (y - extent.low[1]) * scale;
      y = down;
    }
    function(corners, panel.values[t], colours.at(panel.values[t]));
  }
}

void drawOutlines(const Canvas& canvas, const TactilePanel& panel, const PanelSize& size, const ColourScale& scale) {
  eachOutline(panel, size, scale, [&](const TaxelOutline& corners, double, const Colour& colour) {
    for (const auto& [x, y] : corners) cairo_line_to(canvas, x, y);
    cairo_close_path(canvas);
    canvas.colour(colour);
    cairo_fill_preserve(canvas);
    canvas.colour(kPaper);
    cairo_set_line_width(canvas, 0.7);
    cairo_stroke(canvas);
  });
}

void drawCells(const Canvas& canvas, const TactilePanel& panel, const PanelSize& size, const ColourScale& scale) {
  if (!panel.outlines.empty()) return drawOutlines(canvas, panel, size, scale);
  canvas.colour(kGap);
  cairo_rectangle(canvas, 0, 0, size.width, size.height);
  cairo_fill(canvas);
  const double gap = std::min(0.5, 0.03 * size.cell_width);
  eachCell(panel, scale, [&](int i, int j, double, const Colour& colour) {
    canvas.colour(colour);
    cairo_rectangle(canvas, j * size.cell_width + gap, i * size.cell_height + gap, size.cell_width - 2 * gap, size.cell_height - 2 * gap);
    cairo_fill(canvas);
  });
}

// Values over everything else, each with a halo of its cell's colour, where the widest of the picture fits into a cell.
void drawValues(const Canvas& canvas, const TactilePanel& panel, const PanelSize& size, const ColourScale& scale) {
  canvas.font(kLargestValue);
  const double fit = std::min(0.8 * size.cell_width / canvas.widthOf(valueText(scale.is_signed ? -scale.max : scale.max)),
                              0.5 * size.cell_height / kLargestValue);
  const double type = std::min(kLargestValue * fit, kLargestValue);
  if (type < kSmallestValue) return;
  canvas.font(type);
  const auto write = [&](double x, double y, double value, const Colour& colour) {
    if (value == 0) return;
    const std::string text = valueText(value);
    cairo_move_to(canvas, x - canvas.widthOf(text) / 2, y + 0.36 * type);
    cairo_text_path(canvas, text.c_str());
    canvas.colour(colour);
    cairo_set_line_width(canvas, 0.22 * type);
    cairo_stroke_preserve(canvas);
    canvas.colour(luminance(colour) > kDarkTextFrom ? kInk : kPaper);
    cairo_fill(canvas);
  };
  if (!panel.outlines.empty()) {
    eachOutline(panel, size, scale, [&](const TaxelOutline& c, double value, const Colour& colour) {
      write((c[0][0] + c[2][0]) / 2, (c[0][1] + c[2][1]) / 2, value, colour);
    });
    return;
  }
  eachCell(panel, scale, [&](int i, int j, double value, const Colour& colour) {
    write((j + 0.5) * size.cell_width, (i + 0.5) * size.cell_height, value, colour);
  });
}

// Lines between taxels that report something and taxels that do not.
void drawContour(const Canvas& canvas, const TactilePanel& panel, const PanelSize& size) {
  const auto touched = [&](int i, int j) {
    return i >= 0 && j >= 0 && i < panel.num_rows && j < panel.num_cols &&
           panel.values[static_cast<std::size_t>(i) * panel.num_cols + j] > 0;
  };
  for (int i = 0; i <= panel.num_rows; ++i) {
    for (int j = 0; j <= panel.num_cols; ++j) {
      const double x = j * size.cell_width, y = i * size.cell_height;
      if (touched(i, j) != touched(i - 1, j)) {
        cairo_move_to(canvas, x, y);
        cairo_line_to(canvas, x + size.cell_width, y);
      }
      if (touched(i, j) != touched(i, j - 1)) {
        cairo_move_to(canvas, x, y);
        cairo_line_to(canvas, x, y + size.cell_height);
      }
    }
  }
  canvas.colour(kContour);
  cairo_set_line_width(canvas, 2.2);
  cairo_stroke(canvas);
}

// Both axes of the contact, two standard deviations to each side, and a dot at its centre.
void drawAxes(const Canvas& canvas, const TactilePanel& panel, const PanelSize& size) {
  if (!panel.axes) return;
  const ContactAxes& axes = *panel.axes;
  const auto place = [&](double x, double y) {
    return std::array{(y / panel.pitch[1] + 0.5 * panel.num_cols) * size.cell_width,
                      (x / panel.pitch[0] + 0.5 * panel.num_rows) * size.cell_height};
  };
  cairo_save(canvas);
  cairo_rectangle(canvas, 0, 0, size.width, size.height);
  cairo_clip(canvas);
  for (int k = 0; k < 2; ++k) {
    const double half = 2 * std::sqrt(std::max(axes.eigenvalues[k], 0.0));
    const double angle = axes.angle + k * std::numbers::pi / 2;
    const auto from = place(axes.centre[0] - half * std::cos(angle), axes.centre[1] - half * std::sin(angle));
    const auto to = place(axes.centre[0] + half * std::cos(angle), axes.centre[1] + half * std::sin(angle));
    for (const auto& [colour, halo] : {std::pair{kPaper, 1.4}, std::pair{kAxis, 0.0}}) {
      cairo_move_to(canvas, from[0], from[1]);
      cairo_line_to(canvas, to[0], to[1]);
      canvas.colour(colour);
      cairo_set_line_width(canvas, (k == 0 ? 2.8 : 1.6) + halo);
      cairo_stroke(canvas);
    }
  }
  const auto centre = place(axes.centre[0], axes.centre[1]);
  cairo_arc(canvas, centre[0], centre[1], 3.4, 0, 2 * std::numbers::pi);
  canvas.colour(kPaper);
  cairo_fill_preserve(canvas);
  canvas.colour(kAxis);
  cairo_set_line_width(canvas, 1.8);
  cairo_stroke(canvas);
  cairo_restore(canvas);
}

// Lines right across the image.
void drawLines(const Canvas& canvas, const TactilePanel& panel, const PanelSize& size) {
  cairo_save(canvas);
  cairo_rectangle(canvas, 0, 0, size.width, size.height);
  cairo_clip(canvas);
  std::array<double, 2> low{-0.5 * panel.num_rows * panel.pitch[0], -0.5 * panel.num_cols * panel.pitch[1]};
  std::array<double, 2> scale{size.cell_height / panel.pitch[0], size.cell_width / panel.pitch[1]};
  if (!panel.outlines.empty()) {
    const Extent extent = extentOf(panel.outlines);
    low = extent.low;
    scale.fill(size.height / (extent.high[0] - extent.low[0]));
  }
  const double half = size.width + size.height;  // points: past every corner
  for (const TactileLine& line : panel.lines) {
    const double x = (line.through[1] - low[1]) * scale[1], y = (line.through[0] - low[0]) * scale[0];
    const double dx = half * std::sin(line.angle), dy = half * std::cos(line.angle);
    for (const auto& [colour, halo] : {std::pair{kPaper, 1.6}, std::pair{line.colour, 0.0}}) {
      cairo_move_to(canvas, x - dx, y - dy);
      cairo_line_to(canvas, x + dx, y + dy);
      canvas.colour(colour);
      cairo_set_line_width(canvas, 2.4 + halo);
      cairo_stroke(canvas);
    }
  }
  cairo_restore(canvas);
}

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

// Two small arrows: which way x and y run.
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

// What the lines of all panels are, each once.
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

// Below the panels: which way x and y run, and what the lines are.
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

void writeTactileFigure(const std::filesystem::path& file, const std::vector<TactilePanel>& panels, const FigureOptions& options) {
  if (panels.empty()) throw Error(ErrorKind::kInput, "there is no tactile image to draw");
  ColourScale counts{.colours = kViridis, .max = 0, .is_signed = false}, differences{.colours = kBlueToRed, .max = 0, .is_signed = true};
  std::vector<PanelSize> sizes;
  double widest = 0, highest = 0;
  bool titles = false, captions = false, any_signed = false;
  for (const TactilePanel& panel : panels) {
    double& max = panel.is_signed ? differences.max : counts.max;
    for (const double value : panel.values) max = std::isfinite(value) ? std::max(max, panel.is_signed ? std::abs(value) : value) : max;
    any_signed |= panel.is_signed;
    sizes.push_back(sizeOf(panel));
    widest = std::max(widest, sizes.back().width);
    highest = std::max(highest, sizes.back().height);
    titles |= !panel.title.empty();
    captions |= !panel.caption.empty();
  }
  const std::vector<LegendEntry> legend = legendOf(panels);
  const double title_room = titles ? kTitleRoom : 0, caption_room = captions ? kCaptionRoom : 0;
  const double step_x = widest + kGutter, step_y = title_room + highest + caption_room + kGutter;
  const auto count = static_cast<int>(panels.size());
  const int wanted =
      options.num_columns > 0 ? options.num_columns : static_cast<int>(std::lround(std::sqrt(count * step_y / step_x * 4 / 3)));
  const int num_cols = std::clamp(wanted, 1, count);
  const int num_rows = (count + num_cols - 1) / num_cols;
  const double grid_width = std::max(num_cols * step_x - kGutter, kLeastWidth), grid_height = num_rows * step_y - kGutter;
  const double heading = headingRoom(options.subtitle);
  const double width = kMargin + grid_width + (any_signed ? 2 : 1) * kBarStep + kMargin;
  const double height = heading + grid_height + kMargin + (legend.empty() ? 0 : kLegendRoom);
  if (std::max(width, height) * kPixelsPerPoint > kLargestSide)
    throw Error(ErrorKind::kInput, fmt::format("{} images do not fit into one picture: ask for fewer", count));

  const Canvas canvas(width, height);
  canvas.heading(options.title, options.subtitle, width);

  for (int p = 0; p < count; ++p) {
    const TactilePanel& panel = panels[static_cast<std::size_t>(p)];
    const PanelSize& size = sizes[static_cast<std::size_t>(p)];
    cairo_save(canvas);
    const int row = p / num_cols;
    cairo_translate(canvas, kMargin + p % num_cols * step_x, heading + row * step_y + title_room);
    canvas.colour(kInk);
    canvas.font(kBody, true);
    canvas.text(0, -6, panel.title, 0, widest);
    const ColourScale& scale = panel.is_signed ? differences : counts;
    drawCells(canvas, panel, size, scale);
    if (panel.neighbours) {
      drawAxes(canvas, panel, size);
      drawContour(canvas, panel, size);
    }
    drawLines(canvas, panel, size);
    if (panel.numbers) drawValues(canvas, panel, size, scale);
    canvas.colour(kGrey);
    canvas.font(kSmall);
    canvas.text(0, size.height + kSmall + 5, panel.caption, 0, widest);
    cairo_restore(canvas);
  }

  const double bar_left = kMargin + grid_width + kBarGap, bar_top = heading + title_room;
  const double bar_height = std::min(grid_height - title_room - caption_room, 420.0);
  drawColourBar(canvas, bar_left, bar_top, bar_height, counts, options.unit);
  if (any_signed) drawColourBar(canvas, bar_left + kBarStep, bar_top, bar_height, differences, "difference");

  if (!legend.empty()) drawLegend(canvas, heading + grid_height + 20, legend);
  canvas.save(file);
}

}  // namespace taxelsim::cli
