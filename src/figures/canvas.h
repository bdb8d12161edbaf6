// A page to draw on with Cairo, with the type sizes and axis ticks that all figures share. The figures are in tactile_figure.h and
// line_chart.h.
#pragma once

#include <cairo.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "figures/colours.h"

namespace taxelsim::figures {

// Lengths in points, of kPixelsPerPoint pixels each.
inline constexpr double kPixelsPerPoint = 2;
inline constexpr double kMargin = 24, kGutter = 26;
inline constexpr double kHeading = 17, kBody = 11, kSmall = 9.5;  // sizes of type
inline constexpr double kLargestSide = 30000;                     // pixels; the limit of Cairo's image surfaces is 32767

struct Pixels {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> values;  // (height x width x 3): red, green, blue
};

class Canvas {
 public:
  // Throws Error(kInput) if the page is larger than Cairo supports.
  Canvas(double width, double height);

  operator cairo_t*() const { return cairo_.get(); }  // NOLINT(google-explicit-constructor): passed to C functions only

  void colour(const Colour& c, double alpha = 1) const { cairo_set_source_rgba(*this, c.red, c.green, c.blue, alpha); }
  void font(double size, bool bold = false) const;
  double widthOf(const std::string& text) const;

  // Draws text with its left end (`anchor` 0), middle (1/2) or right end (1) at x and its baseline at y. Text wider than `room` is scaled
  // down.
  void text(double x, double y, const std::string& text, double anchor = 0, double room = 0) const;

  // Draws title and subtitle at the top of the page.
  void heading(const std::string& title, const std::string& subtitle, double width) const;

  // Writes a PNG, whole or not at all. Throws Error(kIo) if the file cannot be written.
  void save(const std::filesystem::path& file) const;

  Pixels pixels() const;

 private:
  std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface_;
  std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cairo_;
};

// Height of heading(), including the gap below it.
double headingRoom(const std::string& subtitle);

// 1, 2 or 5 times a power of ten, for about five ticks over `range` > 0.
double tickStep(double range);

// Multiples of tickStep() from `low` to `high` > `low`.
std::vector<double> ticksOf(double low, double high);

}  // namespace taxelsim::figures
