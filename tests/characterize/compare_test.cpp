// Distances between images against values computed by hand, and undefined values.
#include "taxelsim/compare.h"

#include "sensor/example_sensor.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kRounding = 1e-13;  // relative, of a dozen operations in double
constexpr double kPitch = 2e-3;      // m

Sensor twoByThree() {
  Sensor sensor = exampleSensor();
  sensor.patches = {{.name = "pad", .num_rows = 2, .num_cols = 3, .pitch = {kPitch, kPitch}, .X_SP = {}}};
  sensor.readout.curve = {1000};  // counts / N
  sensor.readout.trigger = 0;
  sensor.readout.adc_bits = 10;
  return sensor;
}

using Image = std::vector<float>;

// Five taxels are active, with differences of 100, 50, 300, 10 and 40 counts; full scale is 1023.
const Image kReal{400, 300, 0, 0, 10, 200};
const Image kSimulated{300, 350, 300, 0, 0, 240};

TEST(CompareImages, ByHand) {
  const ImageComparison comparison = compareImages(twoByThree(), kReal, twoByThree(), kSimulated);
  EXPECT_EQ(comparison.num_active, 5u);
  EXPECT_NEAR(comparison.median_difference, 50 / 1023.0, kRounding);
  EXPECT_NEAR(comparison.mean_difference, 100 / 1023.0, kRounding);
  EXPECT_NEAR(comparison.rms_difference, std::sqrt(104200 / 6.0) / 400, kRounding) << "over all six taxels";
  EXPECT_NEAR(comparison.relative_l1, 500 / 910.0, kRounding);
  EXPECT_NEAR(comparison.cosine, 273000 / std::sqrt(290100 * 360100.0), kRounding);
}

TEST(CompareImages, MedianOfAnEvenNumberIsTheMeanOfTheMiddleTwo) {
  const Image real{100, 200, 300, 400, 0, 0}, simulated{90, 180, 270, 360, 0, 0};
  EXPECT_NEAR(compareImages(twoByThree(), real, twoByThree(), simulated).median_difference, 25 / 1023.0, kRounding);
}

TEST(CompareImages, ContactUsesNominalForces) {
  // Taxels (0, 0) and (0, 2) with 0.3 and 0.1 N: x = -1 mm, y = (-0.3 + 0.1) / 0.4 pitch; the axis along y. Simulated: along x.
  const Image real{300, 0, 100, 0, 0, 0}, simulated{0, 200, 0, 0, 200, 0};
  const ImageComparison comparison = compareImages(twoByThree(), real, twoByThree(), simulated);
  EXPECT_NEAR(comparison.real.total_force, 0.4, kRounding);
  EXPECT_NEAR(comparison.real.center_of_pressure[0], -kPitch / 2, kRounding * kPitch);
  EXPECT_NEAR(comparison.real.center_of_pressure[1], -kPitch / 2, kRounding * kPitch);
  EXPECT_NEAR(std::abs(comparison.real.edge_angle), std::numbers::pi / 2, kRounding);
  EXPECT_NEAR(comparison.simulated.edge_angle, 0, kRounding);
  EXPECT_NEAR(comparison.center_distance, std::hypot(kPitch / 2, kPitch / 2), kRounding);
  EXPECT_NEAR(comparison.angle_difference, std::numbers::pi / 2, kRounding);
}

// Axes at 80 and -80 degrees are 20 degrees apart.
TEST(CompareImages, EdgeAnglesAreEqualModuloPi) {
  const Sensor sensor = exampleSensor();
  const auto line = [](double slope) {
    Image image(84, 0);
    for (int j = 0; j < 14; ++j) image[static_cast<std::size_t>(14 * std::lround(2.5 + slope * (j - 6.5)) + j)] = 1000;
    return image;
  };
  const ImageComparison comparison = compareImages(sensor, line(0.3), sensor, line(-0.3));
  EXPECT_NEAR(comparison.real.edge_angle, -comparison.simulated.edge_angle, 1e-9);
  EXPECT_NEAR(comparison.angle_difference, std::numbers::pi - 2 * std::abs(comparison.real.edge_angle), 1e-9);
  EXPECT_LT(comparison.angle_difference, 0.8);
}

// Each image is read by its own readout: equal forces, different counts.
TEST(CompareImages, UsesTheCurveOfEachSensor) {
  Sensor other = twoByThree();
  other.readout.curve = {500};
  const ImageComparison comparison = compareImages(twoByThree(), Image(6, 100), other, Image(6, 50));
  EXPECT_NEAR(comparison.simulated.total_force, comparison.real.total_force, kRounding);
  EXPECT_NEAR(comparison.center_distance, 0, kRounding);
  EXPECT_NEAR(comparison.relative_l1, 0.5, kRounding);
}

TEST(CompareImages, EmptyImages) {
  const Image empty(6, 0);
  const ImageComparison blind = compareImages(twoByThree(), kReal, twoByThree(), empty);
  EXPECT_NEAR(blind.median_difference, 250 / 1023.0, kRounding);
  EXPECT_NEAR(blind.relative_l1, 1, kRounding);
  EXPECT_TRUE(std::isnan(blind.cosine));
  EXPECT_EQ(blind.simulated.total_force, 0);
  EXPECT_TRUE(std::isnan(blind.simulated.center_of_pressure[0]));
  EXPECT_TRUE(std::isnan(blind.simulated.edge_angle));
  EXPECT_TRUE(std::isnan(blind.center_distance));
  EXPECT_TRUE(std::isnan(blind.angle_difference));

  const ImageComparison invented = compareImages(twoByThree(), empty, twoByThree(), kSimulated);
  EXPECT_NEAR(invented.mean_difference, 1190 / 4.0 / 1023, kRounding);
  for (const double undefined : {invented.rms_difference, invented.relative_l1, invented.cosine}) EXPECT_TRUE(std::isnan(undefined));

  const ImageComparison nothing = compareImages(twoByThree(), empty, twoByThree(), empty);
  EXPECT_EQ(nothing.num_active, 0u);
  for (const double undefined : {nothing.median_difference, nothing.mean_difference, nothing.rms_difference, nothing.relative_l1}) {
    EXPECT_TRUE(std::isnan(undefined));
  }
}

TEST(CompareImages, OneTaxelHasNoAxis) {
  const ImageComparison comparison = compareImages(twoByThree(), Image{0, 0, 0, 0, 70, 0}, twoByThree(), kSimulated);
  EXPECT_TRUE(std::isnan(comparison.real.edge_angle));
  EXPECT_NEAR(comparison.real.total_force, 0.07, kRounding);
}

TEST(CompareImages, RefusesOtherArrays) {
  Sensor turned = twoByThree();
  turned.patches[0].num_rows = 3;
  turned.patches[0].num_cols = 2;
  EXPECT_THROW(compareImages(twoByThree(), kReal, turned, kSimulated), Error);
  EXPECT_THROW(compareImages(twoByThree(), kReal, twoByThree(), Image(5, 0)), Error);
  EXPECT_THROW(compareImages(twoByThree(), Image(7, 0), twoByThree(), kSimulated), Error);
}

TEST(RangeOf, IgnoresUndefinedValues) {
  const ValueRange range = rangeOf(std::vector<double>{3, std::nan(""), 1, 8, 2});
  EXPECT_EQ(range.count, 4u);
  EXPECT_EQ(range.median, 2.5);
  EXPECT_EQ(range.low, 1);
  EXPECT_EQ(range.high, 8);
  EXPECT_EQ(rangeOf({}).count, 0u);
  EXPECT_TRUE(std::isnan(rangeOf({}).median));
}

// The largest sum is 200: contact is the first sum above 10, at 0.7 s.
TEST(RowAfterTouch, CountsFromFivePercentOfTheLargest) {
  const Images images{.num_taxels = 2, .time = {0, 0.5, 0.7, 1.0, 1.6, 2.0}, .counts = {0, 0, 5, 5, 5, 6, 90, 90, 100, 100, 60, 60}};
  EXPECT_EQ(rowAfterTouch(images, 0), 2u);
  EXPECT_EQ(rowAfterTouch(images, 0.3), 3u);
  EXPECT_EQ(rowAfterTouch(images, 0.8), 4u) << "1.5 s: 1.6 s is nearer than 1.0 s";
  EXPECT_EQ(rowAfterTouch(images, 1.3), 5u);
  EXPECT_THROW(rowAfterTouch(images, 1.4), Error);
  EXPECT_THROW(rowAfterTouch(images, -0.1), Error);
  EXPECT_THROW(rowAfterTouch({.num_taxels = 2, .time = {}, .counts = images.counts}, 0), Error);
  EXPECT_THROW(rowAfterTouch({.num_taxels = 2, .time = {0, 1}, .counts = Image(4, 0)}, 0), Error);
}

}  // namespace
}  // namespace taxelsim
