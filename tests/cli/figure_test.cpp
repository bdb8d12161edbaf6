// The picture's geometry by numbers: axes of an image, and where colours land.
#include <cairo.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "cli/tactile_figure.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {
namespace {

constexpr double kRounding = 1e-12;  // a dozen operations in double on values of order 1

TEST(AxesOfImage, OfALineOfTaxels) {
  TactilePanel panel;
  panel.num_rows = 3;
  panel.num_cols = 3;
  panel.pitch = {2, 2};
  panel.values = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const auto diagonal = axesOfImage(panel);
  ASSERT_TRUE(diagonal);
  EXPECT_NEAR(diagonal->angle, std::atan(1.0), kRounding) << "x and y grow together";
  EXPECT_NEAR(diagonal->eigenvalues[0], 2 * (4.0 + 0 + 4.0) / 3, kRounding);
  EXPECT_NEAR(diagonal->eigenvalues[1], 0, kRounding);
  panel.values = {0, 0, 0, 0, 0, 0, 0, 3, 1};
  const auto row = axesOfImage(panel);
  EXPECT_NEAR(row->centre[0], 2, kRounding);
  EXPECT_NEAR(row->centre[1], 0.5, kRounding);
  EXPECT_NEAR(std::abs(row->angle), std::acos(0.0), kRounding) << "along y";
  panel.values.assign(9, 0);
  EXPECT_FALSE(axesOfImage(panel));
}

TEST(Figure, ShowsTheContactWhereItIs) {
  TactilePanel panel;
  panel.num_rows = 2;
  panel.num_cols = 4;
  panel.values = {0, 0, 0, 9, 0, 0, 0, 0};
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "taxelsim-figure-test.png";
  writeTactileFigure(file, {panel}, {.title = "one taxel", .subtitle = "", .unit = "counts"});
  cairo_surface_t* picture = cairo_image_surface_create_from_png(file.c_str());
  ASSERT_EQ(cairo_surface_status(picture), CAIRO_STATUS_SUCCESS);
  const int width = cairo_image_surface_get_width(picture), height = cairo_image_surface_get_height(picture);
  const unsigned char* data = cairo_image_surface_get_data(picture);
  const int stride = cairo_image_surface_get_stride(picture);
  const auto counted = [&](unsigned code) {
    int count = 0;
    double mean_x = 0, mean_y = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto* pixel = reinterpret_cast<const std::uint32_t*>(data + y * stride) + x;
        if ((*pixel & 0xffffff) != code) continue;
        ++count;
        mean_x += x;
        mean_y += y;
      }
    return std::array{static_cast<double>(count), mean_x / count, mean_y / count};
  };
  const auto dark = counted(0x440154), bright = counted(0xfde725);
  EXPECT_GT(dark[0], 5 * bright[0]) << "seven taxels against one";
  EXPECT_GT(bright[1], dark[1]) << "column 3 lies to the right";
  EXPECT_LT(bright[2], dark[2]) << "row 0 lies at the top";
  EXPECT_GT(counted(0xe5322d)[0], 100) << "a red outline";
  cairo_surface_destroy(picture);
  std::filesystem::remove(file);
}

TEST(Figure, RefusesWhatItCannotDraw) {
  EXPECT_THROW(writeTactileFigure("/tmp/x.png", {}, {}), Error);
  TactilePanel panel;
  panel.num_rows = panel.num_cols = 1;
  panel.values = {1};
  EXPECT_THROW(writeTactileFigure("/nowhere/x.png", {panel}, {}), Error);
  EXPECT_THROW(writeTactileFigure("/tmp/x.png", std::vector<TactilePanel>(20000, panel), {}), Error);
}

}  // namespace
}  // namespace taxelsim::cli
