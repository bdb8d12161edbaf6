#include "figures/tactile_panel.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace taxelsim::figures {
namespace {

constexpr double kDarkTextFrom = 0.52;  // luminance of a cell above which dark text has more contrast than white

// Lengths in points.
constexpr double kSmallestValue = 5.5, kLargestValue = 12;  // type sizes in cells
constexpr double kPanelLength = 300;                        // longer side of a panel
constexpr double kSmallestPanel = 90;                       // shorter side, for the captions
constexpr double kArrowHead = 6, kShortestArrow = 4;        // of the arrows of taxels; shorter ones are not drawn

double luminance(const Colour& c) {
  return 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue;
}

std::string valueText(double value) {
  return value == std::round(value) && std::abs(value) < 1e6 ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
}

// Bounding box of all outlines, m.
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

// The cell size is that of the smallest outline, so that values fit into all.
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

// Writes values with a halo of the cell's colour, if the widest value fits into a cell. Above the origins of arrows.
void drawValues(const Canvas& canvas, const TactilePanel& panel, const PanelSize& size, const ColourScale& scale) {
  canvas.font(kLargestValue);
  const double fit = std::min(0.8 * size.cell_width / canvas.widthOf(valueText(scale.is_signed ? -scale.max : scale.max)),
                              0.5 * size.cell_height / kLargestValue);
  const double type = std::min(kLargestValue * fit, kLargestValue);
  if (type < kSmallestValue) return;
  canvas.font(type);
  const double rise = panel.arrows.empty() ? 0 : 0.3 * size.cell_height;
  const auto write = [&](double x, double middle, double value, const Colour& colour) {
    if (value == 0) return;
    const double y = middle - rise;
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

// Boundary between taxels above 0 and the others.
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

// Principal axes of the contact, two standard deviations to each side, and a dot at its centre.
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

// Lines across the whole image.
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
  const double half = size.width + size.height;  // points: beyond every corner
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

// An arrow of `length` points from (x, y) in the direction (dx, dy) of length 1, with a halo.
void drawArrow(const Canvas& canvas, double x, double y, double dx, double dy, double length) {
  const double head = std::min(kArrowHead, 0.6 * length), tip_x = x + length * dx, tip_y = y + length * dy;
  for (const auto& [colour, halo] : {std::pair{kPaper, 1.6}, std::pair{kArrow, 0.0}}) {
    cairo_move_to(canvas, x, y);
    cairo_line_to(canvas, tip_x, tip_y);
    cairo_move_to(canvas, tip_x - head * (dx + 0.6 * dy), tip_y - head * (dy - 0.6 * dx));
    cairo_line_to(canvas, tip_x, tip_y);
    cairo_line_to(canvas, tip_x - head * (dx - 0.6 * dy), tip_y - head * (dy + 0.6 * dx));
    canvas.colour(colour);
    cairo_set_line_width(canvas, 2 + halo);
    cairo_stroke(canvas);
  }
}

// One arrow per taxel, from its centre. The scale refers to the smallest side of a taxel.
void drawArrows(const Canvas& canvas, const TactilePanel& panel, const PanelSize& size, const ColourScale& scale) {
  if (panel.arrows.empty()) return;
  const double points = kArrowTaxels * std::min(size.cell_width, size.cell_height) / scale.top();
  // (right, down) of the arrow of taxel t, whose x and y axes have these directions on the page.
  const auto draw = [&](std::size_t t, double x, double y, const std::array<double, 2>& x_axis, const std::array<double, 2>& y_axis) {
    const auto [along_x, along_y] = panel.arrows[t];
    const double right = along_x * x_axis[0] + along_y * y_axis[0], down = along_x * x_axis[1] + along_y * y_axis[1];
    const double length = std::hypot(right, down);
    if (length * points >= kShortestArrow) drawArrow(canvas, x, y, right / length, down / length, length * points);
  };
  cairo_save(canvas);
  cairo_rectangle(canvas, 0, 0, size.width, size.height);
  cairo_clip(canvas);
  std::size_t t = 0;
  if (panel.outlines.empty()) {
    for (int i = 0; i < panel.num_rows; ++i)
      for (int j = 0; j < panel.num_cols; ++j) draw(t++, (j + 0.5) * size.cell_width, (i + 0.5) * size.cell_height, {0, 1}, {1, 0});
  } else {
    eachOutline(panel, size, scale, [&](const TaxelOutline& c, double, const Colour&) {
      const auto direction = [&c](std::size_t corner) {
        const double right = c[corner][0] - c[0][0], down = c[corner][1] - c[0][1], side = std::hypot(right, down);
        return std::array{right / side, down / side};
      };
      draw(t++, (c[0][0] + c[2][0]) / 2, (c[0][1] + c[2][1]) / 2, direction(3), direction(1));
    });
  }
  cairo_restore(canvas);
}

}  // namespace

Colour ColourScale::at(double value) const {
  return along(colours, (value - low()) / (top() - low()));
}

ColourScale valueScale() {
  return {.colours = kViridis, .max = 0, .is_signed = false};
}

ColourScale differenceScale() {
  return {.colours = kBlueToRed, .max = 0, .is_signed = true};
}

PanelSize sizeOf(const TactilePanel& panel) {
  if (!panel.outlines.empty()) return sizeOfOutlines(panel.outlines);
  const double along_y = panel.num_cols * panel.pitch[1], along_x = panel.num_rows * panel.pitch[0];
  double scale = kPanelLength / std::max(along_x, along_y);
  // Enlarges a narrow strip, up to twice, so that captions fit.
  scale *= std::clamp(kSmallestPanel / (scale * std::min(along_x, along_y)), 1.0, 2.0);
  return {panel.pitch[1] * scale, panel.pitch[0] * scale, along_y * scale, along_x * scale};
}

void drawPanel(const Canvas& canvas, const TactilePanel& panel, const PanelSize& size, const ColourScale& scale) {
  drawCells(canvas, panel, size, scale);
  if (panel.neighbours) {
    drawAxes(canvas, panel, size);
    drawContour(canvas, panel, size);
  }
  drawLines(canvas, panel, size);
  drawArrows(canvas, panel, size, scale);
  if (panel.numbers) drawValues(canvas, panel, size, scale);
}

}  // namespace taxelsim::figures
