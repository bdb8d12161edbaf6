// Pixels of a PNG by colour: their number and position.
#pragma once

#include <cairo.h>

#include "support/test.h"

namespace taxelsim::testing {

class Picture {
 public:
  struct Spot {
    int count = 0;
    double x = 0, y = 0;  // pixels from the upper left corner, mean; NaN for none
    int left = 0, right = 0, top = 0, bottom = 0;
  };

  explicit Picture(const std::filesystem::path& file) : surface_(cairo_image_surface_create_from_png(file.c_str())) {
    EXPECT_EQ(cairo_surface_status(surface_), CAIRO_STATUS_SUCCESS) << file;
  }
  ~Picture() { cairo_surface_destroy(surface_); }
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;

  int width() const { return cairo_image_surface_get_width(surface_); }
  int height() const { return cairo_image_surface_get_height(surface_); }

  // Pixels of exactly this colour, 0xrrggbb.
  Spot of(unsigned code) const {
    const unsigned char* data = cairo_image_surface_get_data(surface_);
    const int stride = cairo_image_surface_get_stride(surface_);
    Spot spot{.left = width(), .right = -1, .top = height(), .bottom = -1};
    for (int y = 0; y < height(); ++y) {
      for (int x = 0; x < width(); ++x) {
        const auto* pixel = reinterpret_cast<const std::uint32_t*>(data + y * stride) + x;
        if ((*pixel & 0xffffff) != code) continue;
        ++spot.count;
        spot.x += x;
        spot.y += y;
        spot.left = std::min(spot.left, x), spot.right = std::max(spot.right, x);
        spot.top = std::min(spot.top, y), spot.bottom = std::max(spot.bottom, y);
      }
    }
    spot.x /= spot.count;
    spot.y /= spot.count;
    return spot;
  }

 private:
  cairo_surface_t* surface_;
};

}  // namespace taxelsim::testing
