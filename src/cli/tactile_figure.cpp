#include "cli/tactile_figure.h"

#include <cairo.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "taxelsim/error.h"

namespace taxelsim::cli {
namespace {

struct Colour {
  double red = 0, green = 0, blue = 0;
};

constexpr Colour rgb(unsigned code) {
  return {(code >> 16) / 255.0, (code >> 8 & 255) / 255.0, (code & 255) / 255.0};
}

// Viridis (Smith, van der Walt and Firing, 2015) at eleven even places: lightness rises evenly, and it reads in grey and to the
// colour-blind.
constexpr std::array<Colour, 11> kViridis{rgb(0x440154), rgb(0x482475), rgb(0x414487), rgb(0x355f8d), rgb(0x2a788e), rgb(0x21918c),
                                          rgb(0x22a884), rgb(0x44bf70), rgb(0x7ad151), rgb(0xbddf26), rgb(0xfde725)};
constexpr Colour kInk = rgb(0x1f2430), kGrey = rgb(0x6b7280), kPaper = rgb(0xffffff), kGap = rgb(0xe8eaee);
constexpr Colour kContour = rgb(0xe5322d), kAxis = rgb(0x2f7de1);
constexpr double kDarkTextFrom = 0.52;  // luminance of a cell from which on dark type reads better than white
constexpr const char* kFont = "DejaVu Sans";

// Lengths in points; the picture has kPixelsPerPoint pixels a point.
constexpr double kPixelsPerPoint = 2;
constexpr double kMargin = 24, kGutter = 26;
constexpr double kHeading = 17, kBody = 11, kSmall = 9.5;   // sizes of type
constexpr double kSmallestValue = 5.5, kLargestValue = 12;  // sizes of type in cells
constexpr double kPanelLength = 300;                        // longer side of a panel
constexpr double kSmallestPanel = 90;                       // shorter side, which makes room for captions
constexpr double kLeastWidth = 330;                         // of all panels, which makes room for the title
constexpr double kBarWidth = 14, kBarGap = 22, kBarText = 52;
constexpr double kTitleRoom = 17, kCaptionRoom = 19, kLegendRoom = 24;
constexpr double kLargestSide = 30000;  // pixels; Cairo's image surfaces end at 32767
constexpr int kTicks = 5;

Colour viridis(double t) {
  const double place = std::clamp(t, 0.0, 1.0) * (kViridis.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), kViridis.size() - 2);
  const double f = place - static_cast<double>(i);
  const auto mix = [f](double a, double b) { return a + f * (b - a); };
  return {mix(kViridis[i].red, kViridis[i + 1].red), mix(kViridis[i].green, kViridis[i + 1].green),
          mix(kViridis[i].blue, kViridis[i + 1].blue)};
}

double luminance(const Colour& c) {
  return 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue;
}

// A step of 1, 2 or 5 times a power of ten that gives about kTicks ticks.
double tickStep(double max) {
  const double raw = max / kTicks;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * power >= raw) return step * power;
  return 10 * power;
}

std::string valueText(double value) {
  return value == std::round(value) && std::abs(value) < 1e6 ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
}

class Canvas {
 public:
  Canvas(double width, double height)
      : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::ceil(width * kPixelsPerPoint)),
                                            static_cast<int>(std::ceil(height * kPixelsPerPoint))),
                 cairo_surface_destroy),
        cairo_(cairo_create(surface_.get()), cairo_destroy) {
    if (cairo_status(cairo_.get()) != CAIRO_STATUS_SUCCESS)
      throw Error(ErrorKind::kInput, fmt::format("cannot draw a picture of {:.0f} x {:.0f} points: {}", width, height,
                                                 cairo_status_to_string(cairo_status(cairo_.get()))));
    cairo_scale(*this, kPixelsPerPoint, kPixelsPerPoint);
    colour(kPaper);
    cairo_paint(*this);
    cairo_set_line_join(*this, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(*this, CAIRO_LINE_CAP_ROUND);
  }

  operator cairo_t*() const { return cairo_.get(); }  // NOLINT(google-explicit-constructor): passed to C functions only

  void colour(const Colour& c, double alpha = 1) const { cairo_set_source_rgba(*this, c.red, c.green, c.blue, alpha); }

  void font(double size, bool bold = false) const {
    cairo_select_font_face(*this, kFont, CAIRO_FONT_SLANT_NORMAL, bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(*this, size);
  }

  double widthOf(const std::string& text) const {
    cairo_text_extents_t extents;
    cairo_text_extents(*this, text.c_str(), &extents);
    return extents.x_advance;
  }

  // `anchor` 0 puts the left end at x, 1/2 the middle, 1 the right end; y is the baseline. Text longer than `room` is set smaller.
  void text(double x, double y, const std::string& text, double anchor = 0, double room = 0) const {
    cairo_save(*this);
    const double width = widthOf(text);
    const double scale = room > 0 && width > room ? room / width : 1;
    cairo_translate(*this, x - anchor * width * scale, y);
    cairo_scale(*this, scale, scale);
    cairo_move_to(*this, 0, 0);
    cairo_show_text(*this, text.c_str());
    cairo_restore(*this);
    cairo_new_path(*this);
  }

  void save(const std::filesystem::path& file) const {
    const cairo_status_t status = cairo_surface_write_to_png(surface_.get(), file.c_str());
    if (status != CAIRO_STATUS_SUCCESS)
      throw Error(ErrorKind::kIo, "cannot write " + file.string() + ": " + cairo_status_to_string(status));
  }

 private:
  std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface_;
  std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cairo_;
};

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
void eachCell(const TactilePanel& panel, double max, Function function) {
  for (int i = 0; i < panel.num_rows; ++i) {
    for (int j = 0; j < panel.num_cols; ++j) {
      const double value = panel.values[static_cast<std::size_t>(i) * panel.num_cols + j];
      if (std::isfinite(value)) function(i, j, value, viridis(max > 0 ? value / max : 0));
    }
  }
}

// Calls function(corners in points, value, colour) for every outline that has a value.
template <typename Function>
void eachOutline(const TactilePanel& panel, const PanelSize& size, double max, Function function) {
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
    function(corners, panel.values[t], viridis(max > 0 ? panel.values[t] / max : 0));
  }
}

void drawOutlines(const Canvas& canvas, const TactilePanel& panel, const PanelSize& size, double max) {
  eachOutline(panel, size, max, [&](const TaxelOutline& corners, double, const Colour& colour) {
    for (const auto& [x, y] : corners) cairo_line_to(canvas, x, y);
    cairo_close_path(canvas);
    canvas.colour(colour);
    cairo_fill_preserve(canvas);
    canvas.colour(kPaper);
    cairo_set_line_width(canvas, 0.7);
    cairo_stroke(canvas);
  });
}

void drawCells(const Canvas& canvas, const TactilePanel& panel, const PanelSize& size, double max) {
  if (!panel.outlines.empty()) return drawOutlines(canvas, panel, size, max);
  canvas.colour(kGap);
  cairo_rectangle(canvas, 0, 0, size.width, size.height);
  cairo_fill(canvas);
  const double gap = std::min(0.5, 0.03 * size.cell_width);
  eachCell(panel, max, [&](int i, int j, double, const Colour& colour) {
    canvas.colour(colour);
    cairo_rectangle(canvas, j * size.cell_width + gap, i * size.cell_height + gap, size.cell_width - 2 * gap, size.cell_height - 2 * gap);
    cairo_fill(canvas);
  });
}

// Values over everything else, each with a halo of its cell's colour, where the widest of the picture fits into a cell.
void drawValues(const Canvas& canvas, const TactilePanel& panel, const PanelSize& size, double max) {
  canvas.font(kLargestValue);
  const double fit = std::min(0.8 * size.cell_width / canvas.widthOf(valueText(max)), 0.5 * size.cell_height / kLargestValue);
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
    eachOutline(panel, size, max, [&](const TaxelOutline& c, double value, const Colour& colour) {
      write((c[0][0] + c[2][0]) / 2, (c[0][1] + c[2][1]) / 2, value, colour);
    });
    return;
  }
  eachCell(panel, max, [&](int i, int j, double value, const Colour& colour) {
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

void drawColourBar(const Canvas& canvas, double x, double y, double height, double max, const std::string& unit) {
  cairo_pattern_t* pattern = cairo_pattern_create_linear(0, y + height, 0, y);
  for (std::size_t i = 0; i < kViridis.size(); ++i)
    cairo_pattern_add_color_stop_rgb(pattern, static_cast<double>(i) / (kViridis.size() - 1), kViridis[i].red, kViridis[i].green,
                                     kViridis[i].blue);
  cairo_rectangle(canvas, x, y, kBarWidth, height);
  cairo_set_source(canvas, pattern);
  cairo_fill(canvas);
  cairo_pattern_destroy(pattern);

  canvas.font(kSmall);
  cairo_set_line_width(canvas, 0.8);
  const double top = max > 0 ? max : 1;
  const double step = tickStep(top);
  for (int tick = 0; tick * step <= top * (1 + 1e-9); ++tick) {
    const double level = y + height * (1 - tick * step / top);
    canvas.colour(kGrey);
    cairo_move_to(canvas, x + kBarWidth, level);
    cairo_line_to(canvas, x + kBarWidth + 4, level);
    cairo_stroke(canvas);
    canvas.colour(kInk);
    canvas.text(x + kBarWidth + 7, level + 0.36 * kSmall, fmt::format("{:g}", tick * step));
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

// Below the panels: which way x and y run, and what the lines are.
void drawLegend(const Canvas& canvas, double foot) {
  drawFrame(canvas, kMargin + 4, foot);
  double x = kMargin + 52;
  canvas.font(kSmall);
  for (const auto& [colour, word] :
       {std::pair{kContour, "outline of the contact"}, std::pair{kAxis, "principal axes, 2 standard deviations"}}) {
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
  double max = 0;
  std::vector<PanelSize> sizes;
  double widest = 0, highest = 0;
  bool titles = false, captions = false, neighbours = false;
  for (const TactilePanel& panel : panels) {
    for (const double value : panel.values) max = std::isfinite(value) ? std::max(max, value) : max;
    sizes.push_back(sizeOf(panel));
    widest = std::max(widest, sizes.back().width);
    highest = std::max(highest, sizes.back().height);
    titles |= !panel.title.empty();
    captions |= !panel.caption.empty();
    neighbours |= panel.neighbours;
  }
  const double title_room = titles ? kTitleRoom : 0, caption_room = captions ? kCaptionRoom : 0;
  const double step_x = widest + kGutter, step_y = title_room + highest + caption_room + kGutter;
  const auto count = static_cast<int>(panels.size());
  const int wanted =
      options.num_columns > 0 ? options.num_columns : static_cast<int>(std::lround(std::sqrt(count * step_y / step_x * 4 / 3)));
  const int num_cols = std::clamp(wanted, 1, count);
  const int num_rows = (count + num_cols - 1) / num_cols;
  const double grid_width = std::max(num_cols * step_x - kGutter, kLeastWidth), grid_height = num_rows * step_y - kGutter;
  const double heading = kMargin + kHeading + (options.subtitle.empty() ? 0 : kBody + 8) + 20;
  const double width = kMargin + grid_width + kBarGap + kBarWidth + kBarText + kMargin;
  const double height = heading + grid_height + kMargin + (neighbours ? kLegendRoom : 0);
  if (std::max(width, height) * kPixelsPerPoint > kLargestSide)
    throw Error(ErrorKind::kInput, fmt::format("{} images do not fit into one picture: ask for fewer", count));

  const Canvas canvas(width, height);
  canvas.colour(kInk);
  canvas.font(kHeading, true);
  canvas.text(kMargin, kMargin + 0.75 * kHeading, options.title, 0, width - 2 * kMargin);
  canvas.colour(kGrey);
  canvas.font(kBody);
  canvas.text(kMargin, kMargin + kHeading + 0.9 * kBody + 4, options.subtitle, 0, width - 2 * kMargin);

  for (int p = 0; p < count; ++p) {
    const TactilePanel& panel = panels[static_cast<std::size_t>(p)];
    const PanelSize& size = sizes[static_cast<std::size_t>(p)];
    cairo_save(canvas);
    const int row = p / num_cols;
    cairo_translate(canvas, kMargin + p % num_cols * step_x, heading + row * step_y + title_room);
    canvas.colour(kInk);
    canvas.font(kBody, true);
    canvas.text(0, -6, panel.title, 0, widest);
    drawCells(canvas, panel, size, max);
    if (panel.neighbours) {
      drawAxes(canvas, panel, size);
      drawContour(canvas, panel, size);
    }
    drawValues(canvas, panel, size, max);
    canvas.colour(kGrey);
    canvas.font(kSmall);
    canvas.text(0, size.height + kSmall + 5, panel.caption, 0, widest);
    cairo_restore(canvas);
  }

  const double bar_top = heading + title_room;
  drawColourBar(canvas, kMargin + grid_width + kBarGap, bar_top, std::min(grid_height - title_room - caption_room, 420.0), max,
                options.unit);

  if (neighbours) drawLegend(canvas, heading + grid_height + 20);
  canvas.save(file);
}

}  // namespace taxelsim::cli
