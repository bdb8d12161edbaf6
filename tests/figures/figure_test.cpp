// Geometry of figures: axes of an image, and positions of colours.
#include "cli/picture.h"
#include "figures/tactile_figure.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim::figures {
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
  const testing::Picture picture(file);
  const auto dark = picture.of(0x440154), bright = picture.of(0xfde725);
  EXPECT_GT(dark.count, 5 * bright.count) << "seven taxels against one";
  EXPECT_GT(bright.x, dark.x) << "column 3 lies to the right";
  EXPECT_LT(bright.y, dark.y) << "row 0 lies at the top";
  EXPECT_GT(picture.of(0xe5322d).count, 100) << "a red outline";
  std::filesystem::remove(file);
}

// x points down and y right: a line along y is horizontal, one along x vertical; in grids and in outlines.
TEST(Figure, DrawsLinesAtTheirPlace) {
  TactilePanel grid;
  grid.num_rows = grid.num_cols = 3;
  grid.values.assign(9, 1);
  grid.numbers = false;
  TactilePanel outlines = grid;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double x = i - 1.5, y = j - 1.5;
      outlines.outlines.push_back({{{x, y}, {x, y + 1}, {x + 1, y + 1}, {x + 1, y}}});
    }
  }
  grid.neighbours = outlines.neighbours = false;
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "taxelsim-lines-test.png";
  for (const TactilePanel& panel : {grid, outlines}) {
    for (const double angle : {0.0, std::acos(0.0)}) {
      TactilePanel drawn = panel;
      drawn.lines = {{.through = {-1, 1}, .angle = angle, .colour = rgb(0x123456), .name = ""}};
      writeTactileFigure(file, {drawn}, {.title = "", .subtitle = "", .unit = ""});
      const testing::Picture picture(file);
      // The legend has a short line of this colour, too; the long one is in the image.
      const testing::Picture::Spot line = picture.of(0x123456), cells = picture.of(0xfde725);
      if (angle == 0) {
        EXPECT_GT(line.right, (cells.left + cells.right) / 2) << "y is 1: in the last column";
        EXPECT_LE(line.top, cells.top + 4) << "from the first row on";
      } else {
        EXPECT_NEAR(line.right, cells.right, 4) << "across the image";
        EXPECT_NEAR(line.top, cells.top + (cells.bottom - cells.top) / 6, 8) << "x is -1: in the first row";
      }
    }
  }
  std::filesystem::remove(file);
}

// Arrows begin in the middle of their taxel: along x down, along y to the right; in grids and in outlines.
TEST(Figure, DrawsArrowsAlongTheAxesOfTheTaxels) {
  TactilePanel grid;
  grid.num_rows = grid.num_cols = 1;
  grid.values = {1};
  grid.numbers = grid.neighbours = false;
  TactilePanel outline = grid, turned = grid;
  outline.outlines = {{{{-1, -1}, {-1, 1}, {1, 1}, {1, -1}}}};
  turned.outlines = {{{{1, -1}, {-1, -1}, {-1, 1}, {1, 1}}}};  // its x points right, its y up
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "taxelsim-arrows-test.png";
  const auto drawn = [&](TactilePanel panel, std::array<double, 2> arrow) {
    panel.arrows = {arrow};
    writeTactileFigure(file, {panel}, {.title = "", .subtitle = "", .unit = "counts", .range = 4});
    return testing::Picture(file).of(0xe5322d);
  };
  const auto isTall = [](const testing::Picture::Spot& spot) { return spot.bottom - spot.top > 3 * (spot.right - spot.left); };
  const auto isWide = [](const testing::Picture::Spot& spot) { return spot.right - spot.left > 3 * (spot.bottom - spot.top); };
  for (const TactilePanel& panel : {grid, outline}) {
    EXPECT_TRUE(isTall(drawn(panel, {1, 0})));
    EXPECT_TRUE(isWide(drawn(panel, {0, 1})));
    EXPECT_GT(drawn(panel, {1, 0}).y, drawn(panel, {-1, 0}).y + 100);
    EXPECT_GT(drawn(panel, {0, 1}).x, drawn(panel, {0, -1}).x + 100);
    const auto full = drawn(panel, {1, 0}), half = drawn(panel, {0.5, 0});
    EXPECT_NEAR(full.bottom - full.top, 2 * (half.bottom - half.top), 12) << "pixels; the ends have a width";
  }
  EXPECT_TRUE(isWide(drawn(turned, {1, 0})));
  EXPECT_GT(drawn(turned, {1, 0}).x, drawn(turned, {-1, 0}).x + 100);
  EXPECT_LT(drawn(turned, {0, 1}).y, drawn(turned, {0, -1}).y - 100);
  std::filesystem::remove(file);
}

TEST(Figure, RejectsWhatItCannotDraw) {
  EXPECT_THROW(writeTactileFigure("/tmp/x.png", {}, {}), Error);
  TactilePanel panel;
  panel.num_rows = panel.num_cols = 1;
  panel.values = {1};
  EXPECT_THROW(writeTactileFigure("/nowhere/x.png", {panel}, {}), Error);
  EXPECT_THROW(writeTactileFigure("/tmp/x.png", std::vector<TactilePanel>(20000, panel), {}), Error);
}

}  // namespace
}  // namespace taxelsim::figures
