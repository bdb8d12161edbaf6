// Moments, edge angle and area of images with known values.
#include "reference/features.h"

#include "reference/contact_features.h"
#include "reference/frame.h"
#include "reference/readout.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::Features;
using support::gridSensor;

constexpr double kPi = std::numbers::pi;
constexpr double kPitch = 2e-3;  // m
constexpr double kRounding = 1e-12;

Sensor square(int side) {
  return gridSensor({.num_rows = side, .num_cols = side, .pitch_x = kPitch, .pitch_y = kPitch});
}

Features featuresOf(const Sensor& sensor, const std::vector<double>& force) {
  return reference::cleanFeatures(sensor, force);
}

TEST(Features, EmptyImageIsAllZero) {
  const Features features = featuresOf(square(5), std::vector<double>(25, 0));
  EXPECT_EQ(features.total_force, 0);
  EXPECT_EQ(features.peak_force, 0);
  EXPECT_EQ(features.center_of_pressure, (Vector3{0, 0, 0}));
  EXPECT_EQ(features.second_moments, (std::array<double, 3>{0, 0, 0}));
  EXPECT_EQ(features.edge_angle, 0);
  EXPECT_EQ(features.edge_confidence, 0);
  EXPECT_EQ(features.contact_area, 0);
}

TEST(Features, OneLoadedTaxelHasZeroSecondMoments) {
  std::vector<double> force(25, 0);
  force[1 * 5 + 4] = 3;
  const Features features = featuresOf(square(5), force);
  EXPECT_EQ(features.total_force, 3);
  EXPECT_EQ(features.peak_force, 3);
  EXPECT_NEAR(features.center_of_pressure[0], -kPitch, kRounding);
  EXPECT_NEAR(features.center_of_pressure[1], 2 * kPitch, kRounding);
  EXPECT_NEAR(features.eigenvalues[0], 0, kRounding);
  EXPECT_EQ(features.edge_angle, 0);
  EXPECT_NEAR(features.contact_area, kPitch * kPitch, kRounding);
}

// n taxels in a row have the variance (n^2 - 1) / 12 pitch^2.
TEST(Features, StripsAlongAxesAndDiagonals) {
  const Sensor sensor = square(5);
  const double variance = 24.0 / 12 * kPitch * kPitch;
  struct Case {
    int step_i, step_j;
    double angle, factor;
  };
  for (const Case& c : {Case{1, 0, 0, 1}, Case{0, 1, kPi / 2, 1}, Case{1, 1, kPi / 4, 2}, Case{1, -1, -kPi / 4, 2}}) {
    std::vector<double> force(25, 0);
    for (int n = -2; n <= 2; ++n) {
      force[(2 + n * c.step_i) * 5 + (2 + n * c.step_j)] = 0.7;
    }
    const Features features = featuresOf(sensor, force);
    EXPECT_NEAR(features.edge_angle, c.angle, kRounding);
    EXPECT_NEAR(features.edge_confidence, 1, kRounding);
    EXPECT_NEAR(features.eigenvalues[0], c.factor * variance, kRounding * variance);
    EXPECT_NEAR(features.eigenvalues[1], 0, kRounding * variance);
  }
}

TEST(Features, AngleRangeIsHalfOpen) {
  std::vector<double> force(9, 0);
  force[3] = force[4] = force[5] = 1;
  EXPECT_NEAR(featuresOf(square(3), force).edge_angle, kPi / 2, kRounding);
  force[2] = 1e-19;  // makes xy slightly negative: atan2 alone would return -pi/2
  EXPECT_NEAR(featuresOf(square(3), force).edge_angle, kPi / 2, kRounding);
}

TEST(Features, RoundImageHasNoAngle) {
  const Features features = featuresOf(square(5), std::vector<double>(25, 1));
  EXPECT_NEAR(features.edge_confidence, 0, kRounding);
  EXPECT_NEAR(features.second_moments[0], 2 * kPitch * kPitch, kRounding);
  EXPECT_NEAR(features.second_moments[2], 2 * kPitch * kPitch, kRounding);
}

TEST(Features, MomentsAreInPatchFrameAndCentreInSensorFrame) {
  Sensor sensor = square(5);
  sensor.patches[0].X_SP = {{0.01, 0.02, 0.03}, axisAngle({0, 0, 1}, kPi / 2)};
  std::vector<double> force(25, 0);
  force[2 * 5 + 2] = force[3 * 5 + 2] = 1;  // at x = 0 and x = pitch in P; x of P is y of S
  const Features features = featuresOf(sensor, force);
  EXPECT_NEAR(features.center_of_pressure[0], 0.01, kRounding);
  EXPECT_NEAR(features.center_of_pressure[1], 0.02 + kPitch / 2, kRounding);
  EXPECT_NEAR(features.center_of_pressure[2], 0.03, kRounding);
  EXPECT_NEAR(features.edge_angle, 0, kRounding);  // along x of the patch
}

TEST(Features, MomentsOfSeveralPatchesAreInSensorFrame) {
  Sensor sensor = square(1);
  sensor.patches.push_back(sensor.patches[0]);
  sensor.patches[0].X_SP.position = {-3e-3, -3e-3, 0};
  sensor.patches[1].X_SP = {{3e-3, 3e-3, 1e-3}, axisAngle({0, 0, 1}, 1)};
  const Features features = featuresOf(sensor, {1, 3});
  EXPECT_NEAR(features.edge_angle, kPi / 4, kRounding);
  EXPECT_NEAR(features.second_moments[1], 0.25 * 0.75 * 36e-6, kRounding);
  EXPECT_NEAR(features.center_of_pressure[0], 1.5e-3, kRounding);
  EXPECT_NEAR(features.center_of_pressure[2], 0.75e-3, kRounding);
}

TEST(Features, ContactAreaCountsTaxelsAboveTheirTrigger) {
  Sensor sensor = square(2);
  sensor.readout.trigger = 0.5;
  sensor.readout.curve = {100};
  EXPECT_NEAR(featuresOf(sensor, {0.5, 0.6, 0.4, 9}).contact_area, 2 * kPitch * kPitch, kRounding);
  EXPECT_NEAR(reference::measuredFeatures(sensor, std::vector<std::uint32_t>{0, 1, 0, 0}).contact_area, kPitch * kPitch, kRounding);
  sensor.readout.taxel_gain = {1, 1, 1, 1};
  sensor.readout.taxel_trigger = {0.4, 0.7, 0.3, 10};
  EXPECT_NEAR(featuresOf(sensor, {0.5, 0.6, 0.4, 9}).contact_area, 2 * kPitch * kPitch, kRounding);
}

// Taxels that read without a load are not in contact.
TEST(Features, ATriggerBelowZeroIsNoContact) {
  Sensor sensor = square(2);
  sensor.readout.trigger = -0.5;
  sensor.readout.curve = {100};
  const Features features = featuresOf(sensor, {0, 0.6, 0, 0});
  EXPECT_NEAR(features.contact_area, kPitch * kPitch, kRounding);
  EXPECT_THAT(reference::cleanContactImage(sensor, std::vector<double>{0, 0.6, 0, 0}).reports,
              ::testing::ElementsAre(false, true, false, false));
  EXPECT_THAT(reference::readOut(sensor, std::vector<double>{0, 0.6, 0, 0}), ::testing::ElementsAre(50, 110, 50, 50));
  EXPECT_NEAR(reference::measuredFeatures(sensor, std::vector<std::uint32_t>{50, 110, 50, 50}).total_force, 0.6, 1e-9);
}

TEST(Features, MeasuredFeaturesUseTheNominalCurve) {
  Sensor sensor = square(2);
  sensor.readout = support::paperReadout();
  const Features features = reference::measuredFeatures(sensor, std::vector<std::uint32_t>{1000, 0, 0, 2000});
  EXPECT_NEAR(features.total_force, 0.4 + 3000 * 1.6 / 3840, 1e-9);
  EXPECT_NEAR(features.peak_force, 0.2 + 2000 * 1.6 / 3840, 1e-9);
  EXPECT_NEAR(features.edge_angle, kPi / 4, 1e-9);
}

// Sheppard's correction: binning into taxels adds pitch^2 / 12 to the second moment about the true centre, averaged over sub-cell offsets.
// Sampling at the centres of s cells subtracts pitch^2 / (12 s^2); averaging over K offsets of pitch / K subtracts (pitch / K)^2 / 12.
// Exact for a length that is a whole number of both.
TEST(Features, BinningAddsSheppardsCorrection) {
  constexpr int kNumOffsets = 12, kSamples = 4;
  const Sensor sensor = gridSensor({.num_rows = 16, .num_cols = 3, .pitch_x = kPitch, .pitch_y = kPitch, .samples_per_taxel = kSamples});
  const double length = 7.25 * kPitch;  // 87 offsets, 29 samples
  const Object box(Box{{length, 3 * kPitch, 4e-3}});
  double mean_moment = 0, mean_centre = 0;
  for (int k = 0; k < kNumOffsets; ++k) {
    const double x = ((k + 0.5) / kNumOffsets - 0.5) * kPitch + 1e-3 * kPitch;  // no sample on an edge
    const reference::Frame frame = reference::simulateFrame(sensor, {.objects = {{&box, {{x, 0, 2e-3 - 0.5e-3}}}}});
    const double shift = frame.clean.center_of_pressure[0] - x;
    mean_moment += (frame.clean.second_moments[0] + shift * shift) / kNumOffsets;
    mean_centre += shift / kNumOffsets;
  }
  const double load = length * length / 12, cell = kPitch * kPitch / 12;
  const double expected = load - cell / (kNumOffsets * kNumOffsets) + cell * (1 - 1.0 / (kSamples * kSamples));
  // The shift of 1e-3 pitch that keeps samples off edges biases the offsets.
  EXPECT_NEAR(mean_moment / expected, 1, 1e-5);
  EXPECT_NEAR(mean_centre, 0, 2e-3 * kPitch);
  EXPECT_GT(std::abs(mean_moment - load) / load, 100e-5);  // the correction is significant
}

}  // namespace
}  // namespace taxelsim
