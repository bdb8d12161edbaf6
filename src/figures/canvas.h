// What all pictures share: a page to draw on with Cairo, its colours and sizes of type, ticks of axes. Not a plotting library; the pictures
// are tactile_figure.h and line_chart.h.
#pragma once

#include <cairo.h>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace taxelsim::cli {

struct Colour {
  double red = 0, green = 0, blue = 0;
};

constexpr Colour rgb(unsigned code) {
  return {(code >> 16) / 255.0, (code >> 8 & 255) / 255.0, (code & 255) / 255.0};
}

inline constexpr Colour kInk = rgb(0x1f2430), kGrey = rgb(0x6b7280), kPaper = rgb(0xffffff), kGap = rgb(0xe8eaee);
inline constexpr Colour kRed = rgb(0xe5322d), kBlue = rgb(0x2f7de1), kGreen = rgb(0x18a35a);

// Lengths in points; a picture has kPixelsPerPoint pixels a point.
inline constexpr double kPixelsPerPoint = 2;
inline constexpr double kMargin = 24, kGutter = 26;
inline constexpr double kHeading = 17, kBody = 11, kSmall = 9.5;  // sizes of type
inline constexpr double kLargestSide = 30000;                     // pixels; Cairo's image surfaces end at 32767

class Canvas {
 public:
  // Throws Error(kInput) when the page is larger than Cairo can make.
  Canvas(double width, double height);

  operator cairo_t*() const { return cairo_.get(); }  // NOLINT(google-explicit-constructor): passed to C functions only

  void colour(const Colour& c, double alpha = 1) const { cairo_set_source_rgba(*this, c.red, c.green, c.blue, alpha); }
  void font(double size, bool bold = false) const;
  double widthOf(const std::string& text) const;

  // `anchor` 0 puts the left end at x, 1/2 the middle, 1 the right end; y is the baseline. Text longer than `room` is set smaller.
  void text(double x, double y, const std::string& text, double anchor = 0, double room = 0) const;

  // Title and subtitle at the page's head.
  void heading(const std::string& title, const std::string& subtitle, double width) const;

  // Writes the page as a PNG. Throws Error(kIo) when the file cannot be written.
  void save(const std::filesystem::path& file) const;

 private:
  std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface_;
  std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cairo_;
};

// Room that heading() takes, with what lies between it and the rest.
double headingRoom(const std::string& subtitle);

// A step of 1, 2 or 5 times a power of ten that gives about five ticks over `range` > 0.
double tickStep(double range);

// Multiples of tickStep() from low to high, which is above low.
std::vector<double> ticksOf(double low, double high);

}  // namespace taxelsim::cli
