// Charts checked by pixels: positions of values, room for names, and refusals.
#include "figures/line_chart.h"

#include "cli/picture.h"
#include "support/temporary_directory.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim::figures {
namespace {

using testing::Picture;
using testing::TemporaryDirectory;

// Colours that occur nowhere else in a chart.
constexpr unsigned kRising = 0x123456, kFalling = 0x654321;
constexpr double kBlur = 4;  // pixels: half a line width and its antialiased edge

LinePanel panelWith(std::vector<LineSeries> series) {
  return {.title = "panel", .x_label = "time, s", .y_label = "angle, deg", .series = std::move(series)};
}

TEST(LineChart, DrawsValuesAtTheirPlaceOnTheAxes) {
  const TemporaryDirectory root;
  const std::filesystem::path file = root / "chart.png";
  LinePanel panel = panelWith({{.name = "", .x = {0, 10}, .y = {0, 1}, .colour = rgb(kRising)},
                               {.name = "", .x = {2.5, 7.5}, .y = {1, 1}, .style = LineStyle::kPoints, .colour = rgb(kFalling)}});
  panel.y_range = {0, 2};
  writeLineChart(file, {panel}, {.title = "chart"});
  const Picture picture(file);
  const Picture::Spot line = picture.of(kRising), dots = picture.of(kFalling);
  ASSERT_GT(line.count, 300);
  ASSERT_GT(dots.count, 20);
  const double width = line.right - line.left;
  EXPECT_NEAR(dots.left, line.left + width / 4, 2 * kBlur) << "from a quarter of x";
  EXPECT_NEAR(dots.right, line.left + width * 3 / 4, 2 * kBlur) << "to three quarters";
  EXPECT_NEAR((dots.top + dots.bottom) / 2.0, line.top, 2 * kBlur) << "as high as the line's end";
  // The line crosses the lower half of the plot: its middle is a quarter of the height above the axis.
  EXPECT_NEAR(line.y, (line.top + line.bottom) / 2.0, kBlur);
  EXPECT_GT(picture.of(0xffffff).count, picture.width() * picture.height() / 2) << "paper";
}

TEST(LineChart, GapsLevelsAndBands) {
  const TemporaryDirectory root;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  LinePanel panel = panelWith({{.name = "", .x = {0, 1, 2, 3, 4}, .y = {1, 1, nan, 1, 1}, .colour = rgb(kRising)}});
  writeLineChart(root / "gap.png", {panel}, {.title = "chart"});
  panel.series[0].y[2] = 1;
  writeLineChart(root / "whole.png", {panel}, {.title = "chart"});
  const Picture gap(root / "gap.png"), whole(root / "whole.png");
  EXPECT_NEAR(gap.of(kRising).count, whole.of(kRising).count / 2.0, 0.1 * whole.of(kRising).count);
  EXPECT_EQ(gap.of(kRising).right, whole.of(kRising).right);

  EXPECT_EQ(whole.of(0x18a35a).count, 0);
  panel.reference = LineLevel{.y = 1.5, .name = "reference"};
  panel.marks = {{.x = 1, .name = "I"}};
  writeLineChart(root / "level.png", {panel}, {.title = "chart"});
  const Picture level(root / "level.png");
  EXPECT_GT(level.of(0x18a35a).count, 300) << "a green line, also in the legend";
  EXPECT_GT(level.of(kRising).y, level.of(0x18a35a).y) << "1 lies under 1.5";
}

TEST(LineChart, AnIntervalIsShadedAroundItsCurve) {
  const TemporaryDirectory root;
  LinePanel panel = panelWith({{.name = "", .x = {0, 1}, .y = {1, 1}, .colour = rgb(kRising)}});
  panel.y_range = {0, 2};
  writeLineChart(root / "bare.png", {panel}, {.title = "chart"});
  panel.series[0].low = {0.5, 0.5};
  panel.series[0].high = {1.5, 1.5};
  writeLineChart(root / "interval.png", {panel}, {.title = "chart"});
  const Picture bare(root / "bare.png"), interval(root / "interval.png");
  const Picture::Spot line = bare.of(kRising);
  // Half of the plot's height, which is 190 points at two pixels each, less the line and the grid.
  const double shaded = 0.5 * 380 * (line.right - line.left);
  EXPECT_NEAR(bare.of(0xffffff).count - interval.of(0xffffff).count, shaded, 0.1 * shaded);
  EXPECT_EQ(interval.of(kRising).count, line.count);
}

TEST(LineChart, PanelsAreInColumns) {
  const TemporaryDirectory root;
  const LinePanel panel = panelWith({{.name = "a", .x = {0, 1}, .y = {0, 1}}});
  const auto sizeOf = [&](std::size_t count, int num_columns) {
    const std::filesystem::path file = root / (std::to_string(count) + "_" + std::to_string(num_columns) + ".png");
    writeLineChart(file, std::vector<LinePanel>(count, panel), {.title = "chart", .subtitle = "of panels", .num_columns = num_columns});
    const Picture picture(file);
    return std::array{picture.width(), picture.height()};
  };
  const auto one = sizeOf(1, 1), two = sizeOf(2, 2), four = sizeOf(4, 2), three = sizeOf(3, 2);
  const int step = two[0] - one[0], row = four[1] - two[1];
  EXPECT_GT(step, one[0] / 2);
  EXPECT_GT(row, one[1] / 2);
  EXPECT_EQ(two[1], one[1]);
  EXPECT_EQ(three, four) << "the last row is not full";
  EXPECT_EQ(sizeOf(3, 0), three) << "two columns by default";
}

TEST(LineChart, EqualAxesKeepShapes) {
  const TemporaryDirectory root;
  LinePanel panel = panelWith({{.name = "", .x = {0, 1, 1, 0, 0}, .y = {0, 0, 1, 1, 0}, .colour = rgb(kRising)}});
  panel.equal_axes = true;
  writeLineChart(root / "square.png", {panel}, {.title = "chart"});
  const Picture::Spot square = Picture(root / "square.png").of(kRising);
  EXPECT_NEAR(square.right - square.left, square.bottom - square.top, kBlur);
}

TEST(LineChart, OfNothingAndOfOneValue) {
  const TemporaryDirectory root;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  writeLineChart(root / "chart.png",
                 {panelWith({}), panelWith({{.name = "one", .x = {3}, .y = {5}}}), panelWith({{.name = "none", .x = {nan}, .y = {nan}}}),
                  panelWith({{.name = "flat", .x = {0, 1}, .y = {1e6, 1e6}}})},
                 {.title = "chart"});
  EXPECT_GT(Picture(root / "chart.png").width(), 0);
}

TEST(LineChart, RejectsWhatItCannotDraw) {
  const TemporaryDirectory root;
  const LinePanel good = panelWith({{.name = "a", .x = {0, 1}, .y = {0, 1}}});
  EXPECT_THROW(writeLineChart(root / "x.png", {}, {}), Error);
  EXPECT_THROW(writeLineChart("/nowhere/x.png", {good}, {}), Error);
  EXPECT_THROW(writeLineChart(root / "x.png", std::vector<LinePanel>(500, good), {.num_columns = 500}), Error);
  LinePanel bad = good;
  bad.series[0].y.pop_back();
  EXPECT_THROW(writeLineChart(root / "x.png", {bad}, {}), Error);
  bad = good;
  bad.series[0].low = {0, 0};
  EXPECT_THROW(writeLineChart(root / "x.png", {bad}, {}), Error) << "half an interval";
  bad = good;
  bad.y_range = {1, 1};
  EXPECT_THROW(writeLineChart(root / "x.png", {bad}, {}), Error);
}

TEST(Ticks, AreRoundNumbersWithinTheRange) {
  EXPECT_EQ(ticksOf(0, 5), (std::vector<double>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(ticksOf(-1, 1), (std::vector<double>{-1, -0.5, 0, 0.5, 1}));
  const std::vector<double> fine = ticksOf(0.1, 0.3);
  constexpr double kRounding = 1e-15;
  ASSERT_EQ(fine.size(), 5u);
  EXPECT_NEAR(fine.front(), 0.1, kRounding);
  EXPECT_NEAR(fine.back(), 0.3, kRounding);
}

}  // namespace
}  // namespace taxelsim::figures
