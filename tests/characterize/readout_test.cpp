// Readouts found from force curves, against the parameters that made them.
#include <gmock/gmock.h>

#include "bench_session.h"
#include "characterize/estimates.h"
#include "reference/readout.h"
#include "taxelsim/characterize.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {
namespace {

using support::estimateOf;
using support::holds;

using ::testing::HasSubstr;

constexpr double kNoise = 8;   // counts
constexpr double kTop = 3800;  // counts
const std::vector<TrueTaxel> kTaxels{{2000, 0.05}, {2300, 0.03}, {1900, 0.04}, {2100, 0.06}};

// Every taxel pressed up to 2.4 N and let go, 60 readings each.
ForceCurve pressed(const std::vector<TrueTaxel>& taxels, std::mt19937& random, double noise = kNoise) {
  ForceCurve curve;
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    for (int k = 0; k < 60; ++k) {
      const double force = 2.4 * std::min(k, 59 - k) / 29;
      curve.taxel.push_back(static_cast<int>(t));
      curve.force.push_back(force);
      curve.counts.push_back(reading(taxels[t], force, noise, kTop, random));
    }
  }
  return curve;
}

Characterization characterized(ForceCurve curve) {
  const std::vector<Measurement> measurements{measurementOf("curve", benchSensor(2, 2), std::move(curve))};
  return characterize(measurements);
}

struct Truth {
  double slope = 0;
  double trigger = 0;  // of the readout: of gain F - trigger, mean over taxels
};

Truth truthOf(const std::vector<TrueTaxel>& taxels) {
  Truth truth;
  for (const TrueTaxel& taxel : taxels) truth.slope += taxel.slope / static_cast<double>(taxels.size());
  for (const TrueTaxel& taxel : taxels) truth.trigger += taxel.slope / truth.slope * taxel.trigger / static_cast<double>(taxels.size());
  return truth;
}

TEST(ReadoutFit, IntervalsHoldTheTruthAsOftenAsTheySay) {
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
  // And are not simply wide: a straight line through 42 readings a taxel from 0 to 1.75 N, whose forces have a standard deviation of
  // 0.5 N, four taxels; within 15 %, since the number of readings inside the range differs by a few.
  std::mt19937 random(1);
  const Characterization result = characterized(pressed(kTaxels, random));
  const Estimate& estimate = estimateOf(result, "readout.curve.counts_per_newton");
  const double width = 2 * 2.02 * kNoise / (std::sqrt(42.0 * 4) * 0.5);
  EXPECT_NEAR((estimate.high - estimate.low) / width, 1, 0.15);
}

TEST(ReadoutFit, OutliersDoNotMoveIt) {
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

TEST(ReadoutFit, WhatTheFittedSensorReadsIsWhatWasMeasured) {
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

TEST(ReadoutFit, ATaxelThatDoesNotAnswerIsDead) {
  std::mt19937 random(5);
  std::vector<TrueTaxel> taxels = kTaxels;
  taxels[2].slope = 0;
  const Characterization result = characterized(pressed(taxels, random, 0.3));
  EXPECT_THAT(result.dead_taxels, ::testing::ElementsAre(2));
  EXPECT_EQ(result.sensor.readout.taxel_gain[2], 0);
  const Truth truth = truthOf({taxels[0], taxels[1], taxels[3]});
  EXPECT_TRUE(holds(estimateOf(result, "readout.curve.counts_per_newton"), truth.slope));
}

TEST(ReadoutFit, WithoutAPlateauSaturationIsNotDetermined) {
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

// An amplifier that ends before its converter does: noise stays on the plateau.
TEST(ReadoutFit, APlateauMayBeNoisy) {
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

// The paper's calibration does not think of the spread: what a force leaves to other taxels is not missing from the curve.
TEST(ReadoutFit, TheSpreadIsNoLossOfGain) {
  constexpr double kOwn = 0.6193470306;  // of a Gaussian of half a taxel sampled on 3 x 3, normalised: its middle
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

// Up and down twice, the play by its definition: it follows at a distance of `width`.
TEST(ReadoutFit, HysteresisIsFoundFromTheWayBack) {
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

// Four taxels, their zeros at the first row and at the last 0.06 N and more apart.
TEST(ReadoutFit, ADriftingZeroIsNoHysteresisAndMovesNothing) {
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

TEST(ReadoutFit, WithoutAWayBackHysteresisIsNotDetermined) {
  std::mt19937 random(9);
  ForceCurve curve = pressed(kTaxels, random);
  EXPECT_EQ(estimateOf(characterized(curve), "readout.hysteresis_strength").remark, "the ways up and down do not differ beyond noise");
  ForceCurve up;
  for (std::size_t row = 0; row < curve.force.size(); ++row) {
    if (row % 60 >= 30) continue;
    up.taxel.push_back(curve.taxel[row]);
    up.force.push_back(curve.force[row]);
    up.counts.push_back(curve.counts[row]);
  }
  const Characterization result = characterized(up);
  EXPECT_EQ(estimateOf(result, "readout.hysteresis_strength").remark, "the force only rises");
  EXPECT_TRUE(result.sensor.readout.hysteresis_strength.empty());
}

// 2000 x - 400 x^2 + 50 x^3 counts, x in newtons over the trigger.
ForceCurve bent(std::mt19937& random, int degree) {
  ForceCurve curve;
  curve.curve_degree = degree;
  for (int t = 0; t < 4; ++t) {
    for (int k = 0; k < 80; ++k) {
      const double force = 0.03 * k, x = force - 0.05;
      curve.taxel.push_back(t);
      curve.force.push_back(force);
      const double counts = x > 0 ? x * (2000 + x * (-400 + x * 50)) : 2000 * x;
      curve.counts.push_back(reading({1, 0}, counts, kNoise, kTop, random));
    }
  }
  return curve;
}

TEST(ReadoutFit, APolynomialIsFound) {
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

TEST(ReadoutFit, ADividerIsFound) {
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

// An S: counts at 0.32, 0.64, ... N over the trigger; where the last of them lies the fit has its last knot, too.
const std::vector<double> kPieces{200, 1000, 2200, 3100, 0.95 * kTop};
constexpr double kPiece = 0.32;                          // N
const std::vector<double> kGains{0.95, 1.1, 0.9, 1.05};  // of mean 1
constexpr double kShown = 0.05;                          // N, of gain F - trigger

double outputOfPieces(double x) {
  double begin = 0;
  for (std::size_t k = 0;; ++k) {
    const double from = kPiece * static_cast<double>(k);
    if (x <= from + kPiece || k + 1 == kPieces.size()) return begin + (kPieces[k] - begin) * (x - from) / kPiece;
    begin = kPieces[k];
  }
}

ForceCurve piecewise(std::mt19937& random, int num_pieces) {
  ForceCurve curve;
  curve.curve_segments = num_pieces;
  for (int t = 0; t < 4; ++t) {
    for (int k = 0; k < 100; ++k) {
      const double force = 0.021 * k;
      curve.taxel.push_back(t);
      curve.force.push_back(force);
      curve.counts.push_back(reading({1, 0}, outputOfPieces(kGains[static_cast<std::size_t>(t)] * force - kShown), kNoise, kTop, random));
    }
  }
  return curve;
}

std::string pointName(std::size_t k) {
  return "readout.curve.points[" + std::to_string(k) + "].counts";
}

TEST(ReadoutFit, StraightPiecesAreFound) {
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
  // And are not simply wide: the widest is that of the steepest piece, which makes most of where the trigger lies.
  std::mt19937 random(1);
  const Characterization result = characterized(piecewise(random, 5));
  for (std::size_t k = 0; k < kPieces.size(); ++k) {
    const Estimate& estimate = estimateOf(result, pointName(k));
    EXPECT_LT(estimate.high - estimate.low, 0.01 * kTop) << k;
  }
}

TEST(ReadoutFit, OutliersDoNotMoveStraightPieces) {
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

// Half of the rise within a thirtieth of the forces: pieces become longer with force.
TEST(ReadoutFit, StraightPiecesFollowACurveThatBendsOver) {
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

// Loads that stop short of the end of the range: the table ends where they do.
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

// What lies between 0.68 and 1.3 N over the trigger was not pressed: the knots in there are not told, and the curve goes straight from one
// side to the other.
TEST(ReadoutFit, APieceWithoutReadingsIsNotMadeUp) {
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
  std::vector<std::string> untold;
  for (const Estimate& estimate : result.estimates) {
    if (estimate.parameter != "readout.curve.points") continue;
    EXPECT_FALSE(estimate.determined);
    untold.push_back(estimate.remark);
  }
  EXPECT_EQ(untold.size(), 4u);
  EXPECT_THAT(untold, ::testing::Contains(HasSubstr("from 0.6")));
}

// Readings that bend down at the end and stop there make a parabola fall.
TEST(ReadoutFit, ACurveThatWouldFallLosesADegree) {
  std::mt19937 random(10);
  ForceCurve curve = bent(random, 2);
  for (std::size_t row = 0; row < curve.force.size(); ++row) {
    const double force = curve.force[row];
    curve.counts[row] = reading({1, 0}, force < 1 ? 2000 * force : 2000 - 200 * (force - 1), kNoise, kTop, random);
  }
  const Characterization result = characterized(curve);
  EXPECT_EQ(result.sensor.readout.curve.size(), 1u);
  EXPECT_THAT(result.remarks, ::testing::Contains(HasSubstr("a curve of degree 2 would fall")));
}

TEST(ReadoutFit, WhatTellsNothingIsRefused) {
  const auto refused = [](ForceCurve curve) -> std::string {
    try {
      characterized(std::move(curve));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
      return error.what();
    }
    return "accepted";
  };
  std::mt19937 random(8);
  const std::vector<TrueTaxel> dead(4, TrueTaxel{0, 0});
  EXPECT_THAT(refused(pressed(dead, random, 0)),
              HasSubstr("curve.yaml: no taxel has 4 rows between trigger and saturation; 4 did not answer"));
  EXPECT_THAT(refused({.taxel = {0}, .force = {1}, .counts = {500}, .time = {}}), HasSubstr("curve.yaml: no taxel has 4 rows"));
  ForceCurve clipped = pressed(kTaxels, random);
  std::fill(clipped.counts.begin(), clipped.counts.end(), 4095);
  EXPECT_THAT(refused(clipped), HasSubstr("no taxel has 4 rows"));
  ForceCurve bends = bent(random, 3), pieces = piecewise(random, 3);
  const std::vector<Measurement> both{measurementOf("bends", benchSensor(2, 2), bends), measurementOf("pieces", benchSensor(2, 2), pieces)};
  try {
    characterize(both);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("pieces.yaml: curve_segments stands beside curve_degree or divider"));
  }
}

}  // namespace
}  // namespace taxelsim::testing
