// Readout curves fitted to force curves: polynomials, dividers, straight pieces.
#include "characterize/estimates.h"
#include "characterize/readout_curves.h"
#include "reference/readout.h"
#include "support/test.h"
#include "taxelsim/characterize.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {
namespace {

using support::estimateOf;
using support::holds;

using ::testing::HasSubstr;

TEST(ReadoutFit, FindsAPolynomial) {
  const std::vector<double> truth{2000, -400, 50};
  constexpr int kRuns = 40;
  std::vector<int> hits(3);
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    std::mt19937 random(seed);
    const Characterization result = characterized(bent(random, 3));
    for (std::size_t k = 0; k < 3; ++k) {
      hits[k] += holds(estimateOf(result, "readout.curve.coefficients[" + std::to_string(k) + "]"), truth[k]);
    }
  }
  for (const int count : hits) EXPECT_GE(count, leastHits(kRuns));
}

TEST(ReadoutFit, FindsADivider) {
  constexpr double kLimit = 5000, kSlope = 6000;
  constexpr int kRuns = 40;
  int limit = 0, slope = 0;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    std::mt19937 random(seed);
    ForceCurve curve = bent(random, 1);
    curve.divider = true;
    for (std::size_t row = 0; row < curve.force.size(); ++row) {
      const double y = kSlope * (curve.force[row] - 0.05);
      curve.counts[row] = reading({1, 0}, y > 0 ? y * kLimit / (kLimit + y) : y, kNoise, 4095, random);
    }
    const Characterization result = characterized(curve);
    limit += holds(estimateOf(result, "readout.curve.limit"), kLimit);
    slope += holds(estimateOf(result, "readout.curve.counts_per_newton"), kSlope);
    EXPECT_NEAR(nominalForce(result.sensor.readout, 2500), 2500 / (1 - 0.5) / kSlope + 0.05, 0.005);
  }
  EXPECT_GE(limit, leastHits(kRuns));
  EXPECT_GE(slope, leastHits(kRuns));
}

std::string pointName(std::size_t k) {
  return "readout.curve.points[" + std::to_string(k) + "].counts";
}

TEST(ReadoutFit, FindsStraightPieces) {
  constexpr int kRuns = 60;
  std::vector<int> hits(kPieces.size());
  int trigger = 0, gains = 0;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    std::mt19937 random(seed);
    const Characterization result = characterized(piecewise(random, 5));
    const std::vector<CurvePoint>& points = result.sensor.readout.curve_points;
    ASSERT_EQ(points.size(), kPieces.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
      // Knots are even parts of the force that reaches 0.95 of the range, which is seen to about a thousandth.
      EXPECT_NEAR(points[k].force, kPiece * static_cast<double>(k + 1), 0.005 * points[k].force);
      hits[k] += holds(estimateOf(result, pointName(k)), outputOfPieces(points[k].force));
      EXPECT_EQ(estimateOf(result, pointName(k)).value, points[k].counts);
    }
    trigger += holds(estimateOf(result, "readout.trigger"), kShown);
    for (std::size_t t = 0; t < kGains.size(); ++t) {
      gains += holds(estimateOf(result, "readout.taxel_gain[" + std::to_string(t) + "]"), kGains[t]);
    }
  }
  for (const int count : hits) EXPECT_GE(count, leastHits(kRuns));
  EXPECT_GE(trigger, leastHits(kRuns));
  EXPECT_GE(gains, leastHits(kRuns * 4));
  // The intervals are not too wide: the widest is that of the steepest piece, which makes most of where the trigger lies.
  std::mt19937 random(1);
  const Characterization result = characterized(piecewise(random, 5));
  for (std::size_t k = 0; k < kPieces.size(); ++k) {
    const Estimate& estimate = estimateOf(result, pointName(k));
    EXPECT_LT(estimate.high - estimate.low, 0.01 * kTop) << k;
  }
}

TEST(ReadoutFit, StraightPiecesAreRobustToOutliers) {
  std::mt19937 random(3);
  ForceCurve curve = piecewise(random, 5);
  for (std::size_t row = 5; row < curve.counts.size(); row += 10) curve.counts[row] = row % 20 == 5 ? 0 : 3500;
  const Characterization result = characterized(curve);
  EXPECT_GT(result.fits.front().num_outliers, curve.counts.size() / 20);
  const std::vector<CurvePoint>& points = result.sensor.readout.curve_points;
  ASSERT_EQ(points.size(), 5u);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Estimate& estimate = estimateOf(result, pointName(k));
    EXPECT_NEAR(points[k].counts, outputOfPieces(points[k].force), estimate.high - estimate.low) << k << ": four standard deviations";
  }
}

// Half of the rise is within a thirtieth of the forces: pieces must get longer with force.
TEST(ReadoutFit, StraightPiecesFollowASaturatingCurve) {
  constexpr double kLimit = 3500, kHalf = 0.2;  // N
  std::mt19937 random(14);
  ForceCurve curve;
  curve.curve_segments = 10;
  for (int k = 0; k < 1000; ++k) {
    const double force = 6e-3 * k;
    curve.taxel.push_back(0);
    curve.force.push_back(force);
    curve.counts.push_back(reading({1, 0}, kLimit * force / (force + kHalf), kNoise, 4095, random));
  }
  const Characterization result = characterized(curve);
  // Over a chord from x to 2 x the curve lies at most 0.0176 kLimit, at x = 1.42 kHalf; pieces that are alike are narrower.
  const Readout& readout = result.sensor.readout;
  for (const double force : {0.05, 0.1, 0.3, 0.6, 1.0, 2.0, 4.0, 5.0}) {
    const double output = reference::analogueOutput(readout, force, 1, readout.trigger, 0);
    EXPECT_NEAR(std::min<double>(output, readout.saturation), kLimit * force / (force + kHalf), 0.0176 * kLimit) << force;
  }
}

// The table ends with the loads if these end below the end of the range.
TEST(ReadoutFit, StraightPiecesEndWithTheLoads) {
  std::mt19937 random(12);
  ForceCurve curve = piecewise(random, 6);
  for (double& force : curve.force) force *= 0.5;
  for (std::size_t row = 0; row < curve.force.size(); ++row) {
    curve.counts[row] = reading({1, 0}, outputOfPieces(kGains[row / 100] * curve.force[row] - kShown), kNoise, kTop, random);
  }
  const Characterization result = characterized(curve);
  const std::vector<CurvePoint>& points = result.sensor.readout.curve_points;
  ASSERT_EQ(points.size(), 6u);
  EXPECT_NEAR(points.back().force, 1.1, 0.15) << "1.2 N on a taxel of gain 1.1, of which the last 15 % count alike";
  // Knots that are not the curve's own: each is off by a part of the bends between them, at most 1,875 counts/N over a quarter of a piece.
  for (const double counts : {300.0, 1000.0, 2000.0, 2600.0}) {
    double x = 0;
    while (outputOfPieces(x) < counts) x += 1e-4;
    EXPECT_NEAR(nominalForce(result.sensor.readout, counts), x + kShown, 0.03) << counts;
  }
}

// No readings between 0.68 and 1.3 N above the trigger: the curve has no knots there and is straight.
TEST(ReadoutFit, RemovesKnotsWithoutReadings) {
  std::mt19937 random(13);
  const ForceCurve curve = piecewise(random, 10);
  ForceCurve sparse;
  sparse.curve_segments = 10;
  for (std::size_t row = 0; row < curve.force.size(); ++row) {
    const double x = kGains[row / 100] * curve.force[row] - kShown;
    if (x > 0.64 && x < 1.3) continue;
    sparse.taxel.push_back(curve.taxel[row]);
    sparse.force.push_back(curve.force[row]);
    sparse.counts.push_back(curve.counts[row]);
  }
  const Characterization result = characterized(sparse);
  const std::vector<CurvePoint>& points = result.sensor.readout.curve_points;
  ASSERT_EQ(points.size(), 7u) << "those at 0.8, 0.96 and 1.12 N are gone";
  EXPECT_NEAR(points[3].force, 0.64, 0.01);
  EXPECT_NEAR(points[4].force, 1.28, 0.01);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Estimate& estimate = estimateOf(result, pointName(k));
    EXPECT_TRUE(estimate.determined);
    EXPECT_NEAR(points[k].counts, outputOfPieces(points[k].force), estimate.high - estimate.low) << k << ": four standard deviations";
  }
  std::vector<std::string> missing;
  for (const Estimate& estimate : result.estimates) {
    if (estimate.parameter != "readout.curve.points") continue;
    EXPECT_FALSE(estimate.determined);
    missing.push_back(estimate.remark);
  }
  EXPECT_EQ(missing.size(), 4u);
  EXPECT_THAT(missing, ::testing::Contains(HasSubstr("from 0.6")));
}

// A parabola through readings that decrease at the end falls within the range.
TEST(ReadoutFit, LowersTheDegreeOfAFallingCurve) {
  std::mt19937 random(10);
  ForceCurve curve = bent(random, 2);
  for (std::size_t row = 0; row < curve.force.size(); ++row) {
    const double force = curve.force[row];
    curve.counts[row] = reading({1, 0}, force < 1 ? 2000 * force : 2000 - 200 * (force - 1), kNoise, kTop, random);
  }
  const Characterization result = characterized(curve);
  EXPECT_EQ(result.sensor.readout.curve.size(), 1u);
  EXPECT_THAT(result.remarks, ::testing::Contains(HasSubstr("a curve of degree 2 falls within the range")));
}

// A curve of degree 5 bends freely where a drift of the zero adds to the misfit of its terms: its degree is reduced then.
TEST(ReadoutFit, NeverFallsWithinTheMeasuredForces) {
  int num_reduced = 0;
  Sensor sensor = benchSensor(1, 1);
  sensor.readout.adc_bits = 13;
  sensor.readout.saturation = 8191;
  for (unsigned seed = 0; seed < 6; ++seed) {
    std::mt19937 random(seed);
    ForceCurve curve;
    curve.curve_degree = 5;
    double play = 0;
    for (int k = 0; k < 150; ++k) {
      const double force = 4 * (1 - std::cos(2 * std::numbers::pi * k / 50));
      play = std::clamp(play, force - 0.3, force + 0.3);
      const double y = std::max(0.0, 0.6 * force + 0.4 * play - 0.2 + k / 150.0);
      curve.taxel.push_back(0);
      curve.force.push_back(force);
      curve.counts.push_back(reading({1, 0}, 4000 * y / (1 + y), 150, 8191, random));
    }
    const Readout readout = characterize(std::vector{measurementOf("curve", sensor, curve)}).sensor.readout;
    num_reduced += readout.curve.size() < 5;
    double before = 0;
    for (double force = 0; force <= 8; force += 0.05) {
      double counts = 0, power = 1;
      for (const double coefficient : readout.curve) counts += coefficient * (power *= std::max(0.0, force - readout.trigger));
      counts = std::min(counts, static_cast<double>(readout.saturation));
      EXPECT_GE(counts, before - 1) << seed << ": " << force << " N";
      before = counts;
    }
  }
  EXPECT_GT(num_reduced, 0);
}

}  // namespace
}  // namespace taxelsim::testing
