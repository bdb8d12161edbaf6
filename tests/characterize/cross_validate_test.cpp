// Predictions of left-out measurements by a fitted sensor and by baselines.
#include "taxelsim/cross_validate.h"

#include "characterize/bench_session.h"
#include "characterize/prediction_score.h"
#include "characterize/stamp_baselines.h"
#include "characterize/stamp_bench.h"
#include "figures/cross_validation_text.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double kAll = 1e9;  // N

// A sensor with a trigger of a tenth of the middle load per taxel, which bends a line in the load.
Sensor bentSensor() {
  Sensor sensor = baseSensor();
  sensor.readout.trigger = 0.15;
  for (int t = 0; t < 48; ++t) sensor.readout.taxel_gain.push_back(1 + 0.3 * std::sin(5.0 * t));
  return sensor;
}

std::vector<StampImages> loads(const Sensor& sensor) {
  std::vector<StampImages> stamps;
  for (int n = 0; n < 10; ++n) {
    stamps.push_back(recorded(sensor, {.load = 1.5 + n / 2 * 1.5, .x = 0.5e-3, .seed = 70 + static_cast<std::uint64_t>(n)}));
    stamps.back().fixture = "holder";
  }
  return stamps;
}

// M4 of the true sensor without the gains of its taxels, under the middle load.
double errorWithoutGains(const Sensor& truth) {
  Sensor equal = truth;
  equal.readout.taxel_gain.clear();
  const auto imageOf = [](const Sensor& sensor) {
    const StampImages stamp = recorded(sensor, {.load = 4.5, .x = 0.5e-3, .noise = 0});
    return std::vector<double>(stamp.images.counts.end() - 48, stamp.images.counts.end());
  };
  return scoreOfImage(truth, imageOf(equal), imageOf(truth)).relative_l1;
}

TEST(CrossValidate, AFittedSensorBeatsEveryBaselineOnItsOwnBench) {
  const Sensor truth = bentSensor();
  const std::vector<CrossValidation> results = crossValidate(measured(truth, loads(truth)));
  ASSERT_EQ(results.size(), 1u);
  const std::vector<Predictor>& predictors = results[0].predictors;
  ASSERT_EQ(predictors.size(), 9u);
  const PredictionScore own = medianScore(predictors[0], 0, kAll);
  for (std::size_t p = 1; p < predictors.size(); ++p) {
    ASSERT_EQ(predictors[p].scores.size(), 10u) << predictors[p].name;
    if (!predictors[p].is_baseline) continue;
    EXPECT_LT(own.relative_l1, medianScore(predictors[p], 0, kAll).relative_l1) << predictors[p].name;
  }
  // The simulation samples the skin every 0.43 mm, the fit uses covered areas: 4 % of the side of the stamp.
  EXPECT_LT(own.relative_l1, 0.06);
  EXPECT_LT(own.center_distance, 0.2e-3);
  EXPECT_EQ(medianScore(predictors[1], 0, kAll).relative_l1, 1) << "zeros";
  // The fit has 1 as the mean gain of the loaded taxels, whose true gains have a mean within 0.05 of it. A taxel reads gain times force
  // minus trigger, which is 1.4 times as sensitive as the force.
  EXPECT_EQ(predictors[8].name, "fitted sensor, every gain 1");
  EXPECT_NEAR(medianScore(predictors[8], 0, kAll).relative_l1, errorWithoutGains(truth), 1.4 * 0.05);
  EXPECT_GT(errorWithoutGains(truth), 0.2);
  EXPECT_THAT(figures::crossValidationText(results, 0),
              StartsWith("left-out loads: the fitted sensor predicts better than every baseline"));
}

// The recorded image of the left-out load, moved by a taxel: its prediction must stay where the other loads say.
TEST(CrossValidate, APlacementDoesNotSeeTheScoredImage) {
  const Sensor truth = bentSensor();
  std::vector<StampImages> stamps = loads(truth);
  stamps.resize(6);
  for (std::size_t n = 4; n < 6; ++n) {
    stamps[n] = recorded(truth, {.load = stamps[n].load, .x = 0.5e-3 + kPitch, .seed = 90 + n});
    stamps[n].fixture = "holder";
  }
  const CrossValidation result = crossValidate(measured(truth, stamps)).front();
  // The moved image loses little at the border of the array; half a taxel is far from both 0 and 1.
  EXPECT_GT(result.predictors[0].scores[4].center_distance, 0.5 * kPitch);
  EXPECT_GT(result.predictors[2].scores[4].center_distance, 0.5 * kPitch);
}

std::vector<std::string> namesOf(const Predictor& predictor) {
  std::vector<std::string> names;
  for (const PredictionScore& score : predictor.scores) names.push_back(score.measurement);
  return names;
}

// Three loads at one place without a fixture, one load at a place of its own, and one whose place was measured by hand.
TEST(CrossValidate, APressIsPredictedWhereItsPlaceIsKnown) {
  const Sensor truth = bentSensor();
  std::vector<StampImages> stamps = loads(truth);
  stamps = std::vector<StampImages>(stamps.begin() + 2, stamps.begin() + 8);  // 3, 4.5 and 6 N: 1.5 N lights too few taxels for a place
  for (StampImages& stamp : stamps) stamp.fixture.clear();
  stamps.push_back(recorded(truth, {.load = 5, .x = -2e-3, .y = -5e-3, .seed = 95}));
  stamps.push_back(recorded(truth, {.load = 4, .x = -1e-3, .y = 5e-3, .seed = 96}));
  stamps.back().position = {-1e-3, 5e-3};
  const CrossValidation result = crossValidate(measured(truth, stamps)).front();
  EXPECT_THAT(namesOf(result.predictors[0]), ::testing::ElementsAre("stamp0", "stamp1", "stamp7", "stamp2", "stamp3", "stamp4", "stamp5"));
  EXPECT_EQ(result.remark, "not predicted, because neither another load nor a measured position gives their place: stamp6");
  // Sensor and blurred footprints. The places are 5 mm apart.
  for (const std::size_t predictor : {0, 2, 3}) {
    for (const PredictionScore& score : result.predictors[predictor].scores) {
      EXPECT_LT(score.center_distance, 0.6e-3) << result.predictors[predictor].name << ", " << score.measurement;
    }
  }
  EXPECT_TRUE(std::isnan(result.predictors[4].scores[2].relative_l1)) << "a line needs another press at the place";
  EXPECT_THAT(figures::crossValidationText(std::vector{result}, 0), HasSubstr("\nleft-out loads: not predicted, because"));
}

// Each load at a place of its own, as a hand sets it down.
TEST(CrossValidate, PlacesOfTheirOwnPredictNothing) {
  const Sensor truth = bentSensor();
  const std::vector<StampImages> stamps =
      recordedAll(truth, {{.load = 3, .x = 0.4e-3, .y = -3.1e-3}, {.load = 6, .x = -0.9e-3, .y = 2e-3}});
  const std::vector<CrossValidation> results = crossValidate(measured(truth, stamps));
  ASSERT_EQ(results.size(), 1u);
  EXPECT_TRUE(results[0].predictors[0].scores.empty());
  EXPECT_EQ(
      figures::crossValidationText(results, 0),
      "left-out loads: this set cannot be cross-validated by stamps: no two loads were pressed at one place (fixture), and no stamp has a "
      "measured position\n");
}

TEST(CrossValidate, TheVerdictNamesABetterBaseline) {
  CrossValidation result{
      .left_out = "loads",
      .predictors = {
          {.name = "fitted sensor"}, {.name = "zeros", .is_baseline = true}, {.name = "line", .is_baseline = true}, {.name = "repeat"}}};
  const std::vector<double> m4{0.2, 1, 0.1, 0.01};
  for (std::size_t p = 0; p < m4.size(); ++p) {
    result.predictors[p].scores = {{.load = 1, .relative_l1 = m4[p], .sum_ratio = 1.05},
                                   {.load = 5, .relative_l1 = p == 0 ? 0.05 : m4[p], .sum_ratio = 1.05}};
  }
  EXPECT_THAT(figures::verdictText(result, 3),
              StartsWith("left-out loads: a baseline predicts better than the fitted sensor: M4 below 3 N 20.0 % against 10.0 % (line)"));
  EXPECT_THAT(figures::verdictText(result, 3), ::testing::Not(HasSubstr("repeat")));
  EXPECT_THAT(figures::crossValidationText(std::vector{result}, 3), HasSubstr("median over all loads"));
  EXPECT_THAT(figures::crossValidationText(std::vector{result}, 0), ::testing::Not(HasSubstr("over all loads")));
  result.predictors[0].scores[0].relative_l1 = 0.1;
  EXPECT_THAT(figures::verdictText(result, 3), StartsWith("left-out loads: the fitted sensor predicts better"));
}

// A bench whose stamps carry less of the middle loads.
TEST(CrossValidateStudy, PredictsLoadsOfADeviatingBench) {
  const Sensor truth = bentSensor();
  std::vector<StampImages> stamps;
  for (int n = 0; n < 14; ++n) {
    const double load = 1.5 + n / 2 * 1.2, gain = 1 - 0.25 * std::exp(-std::pow((load - 5) / 1.5, 2));
    stamps.push_back(recorded(truth, {.load = load, .x = 0.5e-3, .gain = gain, .seed = 170 + static_cast<std::uint64_t>(n)}));
    stamps.back().fixture = "holder";
  }
  const CrossValidation result = crossValidate(measured(truth, stamps)).front();
  const double with = medianScore(result.predictors[6], 2, 8).sum_ratio, without = medianScore(result.predictors[0], 2, 8).sum_ratio;
  EXPECT_LT(with, 0.7 * without);
}

TEST(CrossValidate, ScoresByHand) {
  const PredictionScore score = scoreOf(std::vector<double>{10, 0, 40, 0}, std::vector<double>{20, 0, 20, 10}, 100);
  EXPECT_DOUBLE_EQ(score.median_difference, 0.1);
  EXPECT_DOUBLE_EQ(score.relative_l1, 40.0 / 50);
  EXPECT_DOUBLE_EQ(score.sum_ratio, 1);
  EXPECT_DOUBLE_EQ(score.active_ratio, 2.0 / 3);
}

// Presses of one load whose sums scatter by a known standard deviation: the median error of their exact mean is that of a Gaussian,
// whatever the number of presses. The mean of the others alone would give 1.41 or 1.22 times as much.
TEST(CrossValidate, TheExactMeanOfPressesFromRepeats) {
  constexpr double kScatter = 0.05, kMedianOfGaussian = 0.6745;
  constexpr int kLoads = 4000;
  Sensor sensor = baseSensor();
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  std::mt19937 random(11);
  std::normal_distribution<double> scatter(0, kScatter);
  for (const std::size_t num_presses : {2u, 3u}) {
    Predictor mean{.name = "mean"};
    for (int load = 0; load < kLoads; ++load) {
      std::vector<std::vector<double>> images;
      for (std::size_t p = 0; p < num_presses; ++p) images.emplace_back(num_taxels, 1000 * (1 + scatter(random)));
      for (std::size_t p = 0; p < num_presses; ++p) {
        std::vector<std::vector<double>> others = images;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(p));
        mean.scores.push_back(scoreOfMeanPress(sensor, others, images[p]));
      }
    }
    // Errors of two presses of one load are almost equal. A median of n absolute Gaussian values has a standard deviation of
    // 0.787 / sqrt(n), 1.8 % of it at 4000; the ratio of two Gaussians adds the square of their scatter, 0.3 %.
    const PredictionScore found = medianScore(mean, 0, 1);
    EXPECT_NEAR(found.sum_ratio, kMedianOfGaussian * kScatter, 0.08 * kMedianOfGaussian * kScatter) << num_presses;
    EXPECT_NEAR(found.relative_l1, kMedianOfGaussian * kScatter, 0.08 * kMedianOfGaussian * kScatter) << num_presses;
    EXPECT_TRUE(std::isnan(found.active_ratio));
  }
  EXPECT_TRUE(std::isnan(scoreOfMeanPress(sensor, {}, std::vector<double>(num_taxels, 1)).sum_ratio)) << "a single press";
}

TEST(CrossValidate, BaselinesOfPlainPresses) {
  const Indenter stamp = kStamp;
  const std::vector<RecordedPress> seen{{&stamp, 1, {0, 10}}, {&stamp, 3, {20, 10}}};
  EXPECT_THAT(linePerTaxel(seen, {&stamp, 2, {}}), ::testing::ElementsAre(10, 10));
  EXPECT_THAT(linePerTaxel(seen, {&stamp, 0.5, {}}), ::testing::ElementsAre(0, 10));
}

// One taxel, six cycles: the odd ones predict the even ones.
TEST(CrossValidate, CyclesOfAForceCurvePredictEachOther) {
  std::mt19937 random(3);
  ForceCurve curve;
  for (int k = 0; k < 600; ++k) {
    const double force = 1 - std::cos(2 * 3.14159265358979 * k / 100);
    curve.taxel.push_back(0), curve.force.push_back(force);
    curve.counts.push_back(reading({1500, 0.2}, force, 5, 4095, random));
  }
  const CrossValidation result = crossValidate(std::vector{measurementOf("curve", benchSensor(1, 1), curve)}).front();
  ASSERT_EQ(result.predictors[0].scores.size(), 2u);
  EXPECT_LT(medianScore(result.predictors[0], 0, kAll).relative_l1, 0.01) << "noise of 5 counts of 1200";
  EXPECT_GT(medianScore(result.predictors[2], 0, kAll).relative_l1, 0.02) << "a line without a trigger";
}

TEST(CrossValidate, SaysWhatCannotBeLeftOut) {
  const Sensor truth = baseSensor();
  EXPECT_EQ(crossValidate(measured(truth, {recorded(truth, {.load = 2}), recorded(truth, {.load = 2})})).front().remark,
            "this set cannot be cross-validated by stamps: all have one load, two are needed");
  EXPECT_THAT(support::inputError([&] { crossValidate(std::vector<Measurement>{}); }),
              HasSubstr("needs measurements of kind stamp_images or force_curve"));
}

}  // namespace
}  // namespace taxelsim::testing
