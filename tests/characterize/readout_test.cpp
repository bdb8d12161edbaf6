// Readouts fitted to force curves: trigger, gains, saturation, noise, hysteresis, drift.
#include "characterize/estimates.h"
#include "characterize/readout_curves.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/characterize.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {
namespace {

using support::estimateOf;
using support::holds;

using ::testing::HasSubstr;

TEST(ReadoutFit, IntervalsCoverTheTruthAtTheirLevel) {
  const Truth truth = truthOf(kTaxels);
  constexpr int kRuns = 60;
  int slope = 0, trigger = 0, noise = 0, gains = 0;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    std::mt19937 random(seed);
    const Characterization result = characterized(pressed(kTaxels, random));
    slope += holds(estimateOf(result, "readout.curve.counts_per_newton"), truth.slope);
    trigger += holds(estimateOf(result, "readout.trigger"), truth.trigger);
    noise += holds(estimateOf(result, "readout.noise"), kNoise);
    for (std::size_t t = 0; t < kTaxels.size(); ++t) {
      gains += holds(estimateOf(result, "readout.taxel_gain[" + std::to_string(t) + "]"), kTaxels[t].slope / truth.slope);
    }
    EXPECT_EQ(result.sensor.readout.saturation, kTop);
  }
  EXPECT_GE(slope, leastHits(kRuns));
  EXPECT_GE(trigger, leastHits(kRuns));
  EXPECT_GE(noise, leastHits(kRuns));
  EXPECT_GE(gains, leastHits(kRuns * 4)) << "of " << kRuns * 4;
  // The intervals are not too wide: a straight line through 42 readings a taxel from 0 to 1.75 N, whose forces have a standard deviation of
  // 0.5 N, four taxels; within 15 %, since the number of readings inside the range differs by a few.
  std::mt19937 random(1);
  const Characterization result = characterized(pressed(kTaxels, random));
  const Estimate& estimate = estimateOf(result, "readout.curve.counts_per_newton");
  const double width = 2 * 2.02 * kNoise / (std::sqrt(42.0 * 4) * 0.5);
  EXPECT_NEAR((estimate.high - estimate.low) / width, 1, 0.15);
}

TEST(ReadoutFit, IsRobustToOutliers) {
  std::mt19937 random(3);
  const Truth truth = truthOf(kTaxels);
  ForceCurve curve = pressed(kTaxels, random);
  const Characterization clean = characterized(curve);
  for (std::size_t row = 5; row < curve.counts.size(); row += 10) curve.counts[row] = row % 20 == 5 ? 0 : 3500;
  const Characterization result = characterized(curve);
  EXPECT_GT(result.fits.front().num_outliers, curve.counts.size() / 20);
  const Estimate& before = estimateOf(clean, "readout.curve.counts_per_newton");
  const Estimate& after = estimateOf(result, "readout.curve.counts_per_newton");
  // Fewer rows, the same truth: within the sum of both intervals' halves.
  EXPECT_NEAR(after.value, before.value, (before.high - before.low + after.high - after.low) / 2);
  EXPECT_NEAR(after.value, truth.slope, after.high - after.low) << "four standard deviations";
}

TEST(ReadoutFit, FittedSensorReproducesTheMeasurement) {
  std::mt19937 random(4);
  const Characterization result = characterized(pressed(kTaxels, random));
  const Readout& readout = result.sensor.readout;
  for (std::size_t t = 0; t < kTaxels.size(); ++t) {
    for (const double force : {0.3, 1.0, 1.5}) {
      const double counts = readout.curve[0] * (readout.taxel_gain[t] * force - readout.taxel_trigger[t]);
      EXPECT_NEAR(counts, kTaxels[t].slope * (force - kTaxels[t].trigger), kNoise) << "the mean of 40 readings or more";
    }
  }
}

// A foil that reads a quarter of its range without a load.
TEST(ReadoutFit, FindsAnOutputAtRest) {
  constexpr double kFirst = -0.5;  // N
  std::mt19937 random(5);
  ForceCurve curve;
  for (int k = 0; k < 200; ++k) {
    curve.taxel.push_back(0), curve.force.push_back(1.5 * std::min(k, 199 - k) / 99);
    curve.counts.push_back(reading({2000, kFirst}, curve.force.back(), kNoise, 4095, random));
  }
  const Characterization result = characterize(std::vector{measurementOf("foil", benchSensor(1, 1), curve)});
  EXPECT_TRUE(holds(estimateOf(result, "readout.trigger"), kFirst));
  EXPECT_NEAR(result.sensor.readout.trigger, kFirst, 0.01);
  EXPECT_NEAR(result.sensor.readout.taxel_trigger.at(0), kFirst, 0.01);
  EXPECT_THAT(result.remarks, ::testing::Contains(HasSubstr("taxels read without a load")));
  EXPECT_NO_THROW(checkSensor(result.sensor));
}

TEST(ReadoutFit, FindsDeadTaxels) {
  std::mt19937 random(5);
  std::vector<TrueTaxel> taxels = kTaxels;
  taxels[2].slope = 0;
  const Characterization result = characterized(pressed(taxels, random, 0.3));
  EXPECT_THAT(result.dead_taxels, ::testing::ElementsAre(2));
  EXPECT_EQ(result.sensor.readout.taxel_gain[2], 0);
  const Truth truth = truthOf({taxels[0], taxels[1], taxels[3]});
  EXPECT_TRUE(holds(estimateOf(result, "readout.curve.counts_per_newton"), truth.slope));
}

TEST(ReadoutFit, DoesNotDetermineSaturationWithoutAPlateau) {
  std::mt19937 random(6);
  ForceCurve curve = pressed(kTaxels, random);
  for (std::size_t row = 0; row < curve.force.size(); ++row) {
    if (curve.force[row] < 1.5) continue;
    curve.force[row] = 1.5;
    curve.counts[row] = reading(kTaxels[static_cast<std::size_t>(curve.taxel[row])], 1.5, kNoise, kTop, random);
  }
  const Characterization result = characterized(curve);
  EXPECT_FALSE(estimateOf(result, "readout.saturation").determined);
  EXPECT_EQ(result.sensor.readout.saturation, 4095);
}

// An amplifier that clips below the range of its converter has a noisy plateau.
TEST(ReadoutFit, FindsANoisyPlateau) {
  std::mt19937 random(11);
  ForceCurve curve;
  for (int k = 0; k < 200; ++k) {
    curve.taxel.push_back(0);
    curve.force.push_back(0.02 * k);
    curve.counts.push_back(reading({1, 0}, std::min(2000 * 0.02 * k, 3000.0), kNoise, 4095, random));
  }
  const Characterization result = characterized(curve);
  EXPECT_NEAR(result.sensor.readout.saturation, 3000, kNoise) << "the median of 30 readings";
  const Estimate& slope = estimateOf(result, "readout.curve.counts_per_newton");
  EXPECT_NEAR(slope.value, 2000, slope.high - slope.low) << "four standard deviations";
}

// The share of a force that the point spread function moves to other taxels does not lower the curve.
TEST(ReadoutFit, CorrectsTheCurveForThePointSpread) {
  constexpr double kOwn = 0.6193470306;  // middle weight of a normalised 3 x 3 Gaussian with sigma of half a taxel
  Sensor sensor = benchSensor(3, 3);
  sensor.psf = gaussianPsf(0.5, 3);
  std::mt19937 random(7);
  ForceCurve curve;
  for (int k = 0; k < 200; ++k) {
    curve.taxel.push_back(4);
    curve.force.push_back(0.01 * k);
    curve.counts.push_back(reading({2000 * kOwn, 0.05 / kOwn}, 0.01 * k, kNoise, kTop, random));
  }
  const std::vector<Measurement> measurements{measurementOf("curve", sensor, curve)};
  const Characterization result = characterize(measurements);
  EXPECT_TRUE(holds(estimateOf(result, "readout.curve.counts_per_newton"), 2000));
  EXPECT_TRUE(holds(estimateOf(result, "readout.trigger"), 0.05));
  EXPECT_THAT(result.remarks, ::testing::Contains(HasSubstr("8 taxels were not measured")));
}

// Two cycles of loading and unloading. The play follows the force at a distance of `width`.
TEST(ReadoutFit, FindsHysteresisFromUnloading) {
  constexpr double kStrength = 0.2, kWidth = 0.15;
  constexpr int kRuns = 40;
  int strength = 0, width = 0, slope = 0;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    std::mt19937 random(seed);
    ForceCurve curve;
    for (std::size_t t = 0; t < kTaxels.size(); ++t) {
      double play = 0;
      for (int k = 0; k < 120; ++k) {
        const double force = 1.7 * (1 - std::abs(k % 60 - 30) / 30.0);
        if (force > play + kWidth) play = force - kWidth;
        if (force < play - kWidth) play = force + kWidth;
        curve.taxel.push_back(static_cast<int>(t));
        curve.force.push_back(force);
        curve.counts.push_back(reading(kTaxels[t], (1 - kStrength) * force + kStrength * play, kNoise, kTop, random));
      }
    }
    const Characterization result = characterized(curve);
    strength += holds(estimateOf(result, "readout.hysteresis_strength"), kStrength);
    width += holds(estimateOf(result, "readout.hysteresis_width"), kWidth);
    slope += holds(estimateOf(result, "readout.curve.counts_per_newton"), truthOf(kTaxels).slope);
    EXPECT_NEAR(result.sensor.readout.hysteresis_width.at(0), kWidth, 0.05);
  }
  EXPECT_GE(strength, leastHits(kRuns));
  EXPECT_GE(width, leastHits(kRuns));
  EXPECT_GE(slope, leastHits(kRuns));
}

// The zeros of four taxels drift by at least 0.06 N.
TEST(ReadoutFit, SeparatesDriftFromHysteresis) {
  const Truth truth = truthOf(kTaxels);
  const std::vector<double> drifts{0.06, 0.09, -0.06, 0.12};  // N
  int slope = 0, trigger = 0;
  for (unsigned seed = 0; seed < support::kRuns; ++seed) {
    std::mt19937 random(seed);
    ForceCurve curve;
    for (std::size_t t = 0; t < kTaxels.size(); ++t) {
      for (int k = 0; k < 60; ++k) {
        const double force = 2.4 * std::min(k, 59 - k) / 29, drift = drifts[t] * (k / 60.0 - 0.5);
        curve.taxel.push_back(static_cast<int>(t));
        curve.force.push_back(force);
        curve.counts.push_back(reading(kTaxels[t], force - drift, kNoise, kTop, random));
      }
    }
    const Characterization result = characterized(curve);
    slope += holds(estimateOf(result, "readout.curve.counts_per_newton"), truth.slope);
    trigger += holds(estimateOf(result, "readout.trigger"), truth.trigger);
    EXPECT_FALSE(estimateOf(result, "readout.hysteresis_strength").determined);
    EXPECT_THAT(result.remarks, ::testing::Contains(HasSubstr("zero of taxels drifts")));
  }
  EXPECT_GE(slope, support::kLeastInside);
  EXPECT_GE(trigger, support::kLeastInside);
  std::mt19937 random(1);
  EXPECT_THAT(characterized(pressed(kTaxels, random)).remarks, ::testing::Not(::testing::Contains(HasSubstr("drifts"))));
}

TEST(ReadoutFit, DoesNotDetermineHysteresisWithoutUnloading) {
  std::mt19937 random(9);
  ForceCurve curve = pressed(kTaxels, random);
  EXPECT_EQ(estimateOf(characterized(curve), "readout.hysteresis_strength").remark, "loading and unloading do not differ above the noise");
  ForceCurve up;
  for (std::size_t row = 0; row < curve.force.size(); ++row) {
    if (row % 60 >= 30) continue;
    up.taxel.push_back(curve.taxel[row]);
    up.force.push_back(curve.force[row]);
    up.counts.push_back(curve.counts[row]);
  }
  const Characterization result = characterized(up);
  EXPECT_EQ(estimateOf(result, "readout.hysteresis_strength").remark, "no unloading in the measurements");
  EXPECT_TRUE(result.sensor.readout.hysteresis_strength.empty());
}

TEST(ReadoutFit, RejectsUninformativeMeasurements) {
  const auto refused = [](ForceCurve curve) -> std::string { return support::refusal([&] { characterized(std::move(curve)); }); };
  std::mt19937 random(8);
  const std::vector<TrueTaxel> dead(4, TrueTaxel{0, 0});
  EXPECT_THAT(refused(pressed(dead, random, 0)),
              HasSubstr("curve.yaml: no taxel has 4 rows between trigger and saturation; 4 taxels did not respond"));
  EXPECT_THAT(refused({.taxel = {0}, .force = {1}, .counts = {500}, .time = {}}), HasSubstr("curve.yaml: no taxel has 4 rows"));
  ForceCurve clipped = pressed(kTaxels, random);
  std::fill(clipped.counts.begin(), clipped.counts.end(), 4095);
  EXPECT_THAT(refused(clipped), HasSubstr("no taxel has 4 rows"));
  ForceCurve bends = bent(random, 3), pieces = piecewise(random, 3);
  const std::vector<Measurement> both{measurementOf("bends", benchSensor(2, 2), bends), measurementOf("pieces", benchSensor(2, 2), pieces)};
  EXPECT_THAT(support::inputError([&] { characterize(both); }),
              HasSubstr("pieces.yaml: curve_segments and curve_degree or divider are given"));
}

}  // namespace
}  // namespace taxelsim::testing
