// Readout of the reference: the paper's calibration, curves, behaviour below the trigger, rounding and saturation.
#include "reference/readout.h"

#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::readOut;

Sensor sensorWith(const Readout& readout, int num_taxels = 1) {
  Sensor sensor = support::gridSensor({.num_rows = 1, .num_cols = num_taxels});
  sensor.readout = readout;
  return sensor;
}

TEST(Readout, MatchesThePapersCalibration) {
  const Sensor sensor = sensorWith(support::paperReadout());
  const auto counts = [&](double force) { return readOut(sensor, std::vector<double>{force})[0]; };
  EXPECT_EQ(counts(0), 0u);
  EXPECT_EQ(counts(0.2), 0u);
  EXPECT_EQ(counts(1.8), 3840u);
  EXPECT_EQ(counts(0.2 + 4.1666667e-4 * 1000), 1000u);
  EXPECT_EQ(counts(5), 4095u);
  for (const std::uint32_t raw : {1u, 17u, 2000u, 3840u}) {
    EXPECT_NEAR(reference::measuredForce(sensor, std::vector<std::uint32_t>{raw})[0], 0.2 + 4.1666667e-4 * raw, 1e-6);
  }
  EXPECT_EQ(reference::measuredForce(sensor, std::vector<std::uint32_t>{0})[0], 0);
}

TEST(Readout, HalvesRoundAwayFromZero) {
  Readout readout;
  const auto counts = [&](double force) { return readOut(sensorWith(readout), std::vector<double>{force})[0]; };
  EXPECT_EQ(counts(0.5), 1u);
  EXPECT_EQ(counts(1.5), 2u);
  EXPECT_EQ(counts(2.5), 3u);
  EXPECT_EQ(counts(2.4999999), 2u);
}

TEST(Readout, CurveIsPolynomialAboveAndLinearBelowTheTrigger) {
  Readout readout;
  readout.curve = {100, 20, 3};
  readout.trigger = 1;
  readout.output_scale = 2;
  const auto analogue = [&](double force) { return reference::analogueOutput(readout, force, 1, 1, 0); };
  EXPECT_DOUBLE_EQ(analogue(3), 2 * (100 * 2 + 20 * 4 + 3 * 8));
  EXPECT_DOUBLE_EQ(analogue(1), 0);
  EXPECT_DOUBLE_EQ(analogue(0.5), -100);
  // Noise lifts a force below the trigger above zero only if it exceeds the linear part.
  const Sensor sensor = sensorWith(readout, 2);
  EXPECT_EQ(readOut(sensor, std::vector<double>{0.9, 0.9}, {.noise = {19, 25}}), (std::vector<std::uint32_t>{0, 5}));
}

// 0 to 800 counts over the first 0.5 N, to 1900 at 1 N, to 2000 at 2 N: slopes 1600, 2200 and 100 counts/N.
TEST(Readout, PiecewiseLinearCurveInterpolatesAndExtrapolates) {
  Readout readout;
  readout.curve_points = {{0.5, 800}, {1, 1900}, {2, 2000}};
  const auto analogue = [&](double x) { return reference::analogueOutput(readout, x, 1, 0, 0); };
  EXPECT_DOUBLE_EQ(analogue(0), 0);
  EXPECT_DOUBLE_EQ(analogue(0.25), 400);
  EXPECT_DOUBLE_EQ(analogue(0.5), 800);
  EXPECT_DOUBLE_EQ(analogue(0.75), 1350);
  EXPECT_DOUBLE_EQ(analogue(1), 1900);
  EXPECT_DOUBLE_EQ(analogue(1.5), 1950);
  EXPECT_DOUBLE_EQ(analogue(2), 2000);
  EXPECT_DOUBLE_EQ(analogue(7), 2500) << "last slope";
  EXPECT_DOUBLE_EQ(analogue(-0.1), -160) << "first slope";
  readout.output_scale = 2;
  EXPECT_DOUBLE_EQ(reference::analogueOutput(readout, 1, 0.5, -0.25, 7), 2 * 1350 + 7) << "x = 0.5 x 1 + 0.25";
  readout.trigger = 0.25;
  readout.saturation = 2705;
  const Sensor sensor = sensorWith(readout, 4);
  EXPECT_EQ(readOut(sensor, std::vector<double>{0.2, 0.5, 1.0, 1.1}, {.noise = {159, 0, 0, 0}}),
            (std::vector<std::uint32_t>{0, 800, 2700, 2705}))
      << "2 x 1600 x -0.05 + 159 < 0; twice 400, 1350 and 1570 at x = 0.25, 0.75 and 0.85";
  EXPECT_EQ(readOut(sensor, std::vector<double>{0.2, 0, 0, 0}, {.noise = {165, 0, 0, 0}})[0], 5u);
}

TEST(Readout, UsesGainAndTriggerOfEachTaxel) {
  Readout readout;
  readout.curve = {1000};
  readout.trigger = 0.5;
  readout.taxel_gain = {1, 2, 0};
  readout.taxel_trigger = {0.1, 0.2, 0};
  const Sensor sensor = sensorWith(readout, 3);
  EXPECT_EQ(readOut(sensor, std::vector<double>{1, 1, 1}), (std::vector<std::uint32_t>{900, 1800, 0}));
  EXPECT_EQ(readOut(sensor, std::vector<double>{1, 1, 1}, {.gain = {0.5, 1.5, 9}}), (std::vector<std::uint32_t>{400, 2800, 0}));
}

TEST(Readout, ClipsAtSaturationAndReportsTheFraction) {
  Readout readout;
  readout.curve = {100};
  readout.saturation = 255;
  readout.adc_bits = 8;
  const Sensor sensor = sensorWith(readout, 4);
  const auto counts = readOut(sensor, std::vector<double>{2.54, 2.55, 9, 0});
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{254, 255, 255, 0}));
  EXPECT_DOUBLE_EQ(reference::saturatedFraction(sensor, counts), 0.5);
}

TEST(Readout, NominalForceInvertsTheCurve) {
  for (int seed = 0; seed < 200; ++seed) {
    support::Random random(seed);
    const Sensor sensor = support::randomSensor(random);
    const Readout& readout = sensor.readout;
    for (int n = 0; n < 20; ++n) {
      const auto counts = static_cast<std::uint32_t>(random.integer(1, readout.saturation));
      const double force = nominalForce(readout, counts);
      EXPECT_NEAR(reference::analogueOutput(readout, force, 1, readout.trigger, 0), counts, 1e-6 * counts);
    }
  }
}

}  // namespace
}  // namespace taxelsim
