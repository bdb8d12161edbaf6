// Gain and trigger as functions of the temperature: planted coefficients are recovered from force curves and from stamps at several
// temperatures, which formulas and the reference's stages simulate.
#include "characterize/bench_session.h"
#include "characterize/estimates.h"
#include "characterize/stamp_bench.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/cross_validate.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {
namespace {

using support::estimateOf;
using support::findEstimate;
using support::holds;
using ::testing::HasSubstr;

constexpr double kGain = -0.006, kTrigger = 0.0015;  // 1/K, N/K
constexpr double kMean = 40;                         // degrees Celsius: of 20, 40 and 60

// The bench's sensor at a temperature.
Sensor at(const Sensor& sensor, double temperature) {
  return sensorAt({.sensor = sensor,
                   .estimates = {},
                   .fits = {},
                   .figures = {},
                   .dead_taxels = {},
                   .remarks = {},
                   .temperature = TemperatureTerm{kMean, kGain, kTrigger}},
                  temperature);
}

// Curves of six taxels at three temperatures, up and down.
std::vector<Measurement> curves(std::uint32_t seed, double gain, double trigger) {
  std::mt19937 random(seed);
  std::vector<Measurement> measurements;
  for (const double temperature : {20.0, 40.0, 60.0}) {
    ForceCurve curve;
    for (int t = 0; t < 6; ++t) {
      const double slope = 1000 * (0.8 + 0.08 * t), warm_slope = slope * std::exp(gain * (temperature - kMean));
      // The trigger shifts the output by as many newtons at a gain of 1, whatever the temperature.
      const double below = slope * (0.05 + 0.01 * t) + 1000 * trigger * (temperature - kMean);
      const TrueTaxel taxel{warm_slope, below / warm_slope};
      for (int k = 0; k < 24; ++k) {
        const double force = 3.0 * std::min(k, 23 - k) / 11;
        curve.taxel.push_back(t), curve.force.push_back(force);
        curve.counts.push_back(reading(taxel, force, 5, 4095, random));
      }
    }
    measurements.push_back(measurementOf("curve" + std::to_string(measurements.size()), benchSensor(2, 3), curve));
    measurements.back().temperature = temperature;
  }
  return measurements;
}

TEST(Temperature, ForceCurvesGiveItWithRightIntervals) {
  int inside = 0;
  for (std::uint32_t run = 0; run < support::kRuns / 2; ++run) {
    const Characterization result = characterize(curves(run + 1, kGain, kTrigger));
    inside += holds(result, "temperature.gain", kGain);
    // In newtons of the mean taxel, whose slope is 1000 counts/N.
    inside += holds(result, "temperature.trigger", kTrigger);
    ASSERT_TRUE(result.temperature.has_value());
    EXPECT_EQ(result.temperature->reference, kMean);
    EXPECT_NEAR(estimateOf(result, "temperature.gain").value, kGain, 3e-4);
  }
  EXPECT_GE(inside, support::kLeastInside);
}

TEST(Temperature, SensorsThatDoNotChangeHaveNone) {
  const Characterization result = characterize(curves(3, 0, 0));
  EXPECT_TRUE(holds(result, "temperature.gain", 0));
  EXPECT_NEAR(estimateOf(result, "temperature.gain").value, 0, 2e-4);
}

std::vector<Measurement> stamps(const Sensor& truth) {
  std::vector<StampImages> images;
  std::vector<double> temperatures;
  for (int n = 0; n < 12; ++n) {
    temperatures.push_back(20.0 + 20 * (n % 3));
    images.push_back(recorded(at(truth, temperatures.back()),
                              {.load = 2.5 + n / 3 * 1.5, .x = (n % 2) * 2e-3, .seed = 80 + static_cast<std::uint64_t>(n)}));
    images.back().fixture = "holder" + std::to_string(n % 2);
  }
  std::vector<Measurement> measurements = measured(truth, images);
  for (std::size_t n = 0; n < measurements.size(); ++n) measurements[n].temperature = temperatures[n];
  return measurements;
}

TEST(Temperature, StampsGiveIt) {
  Sensor truth = baseSensor();
  truth.readout.trigger = 0.08;
  const std::vector<Measurement> measurements = stamps(truth);
  const Characterization result = characterize(measurements);
  const Estimate &gain = estimateOf(result, "temperature.gain"), &trigger = estimateOf(result, "temperature.trigger");
  // Twice the intervals: one bench.
  EXPECT_NEAR(gain.value, kGain, gain.high - gain.low);
  EXPECT_NEAR(trigger.value, kTrigger, trigger.high - trigger.low);
  EXPECT_LT(gain.high - gain.low, 2e-3) << "a gain that differs by 21 % between 20 and 60 degrees is found within 4 %";
}

// Without temperatures the same images predict a left-out load worse.
TEST(TemperatureStudy, PredictsLeftOutLoads) {
  Sensor truth = baseSensor();
  truth.readout.trigger = 0.08;
  const std::vector<Measurement> measurements = stamps(truth);
  std::vector<Measurement> without = measurements;
  for (Measurement& measurement : without) measurement.temperature.reset();
  const auto error = [](const std::vector<Measurement>& all) {
    return medianScore(crossValidate(all).front().predictors[0], 0, 1e9).relative_l1;
  };
  EXPECT_LT(error(measurements), 0.6 * error(without));
}

TEST(Temperature, SensorAtATemperature) {
  Characterization fitted{.sensor = benchSensor(1, 2), .estimates = {}, .fits = {}, .figures = {}, .dead_taxels = {}, .remarks = {}};
  fitted.sensor.readout.trigger = 0.1;
  EXPECT_EQ(sensorAt(fitted, 99).readout.trigger, 0.1) << "no term";
  fitted.temperature = TemperatureTerm{.reference = 30, .gain_per_kelvin = 0.01, .trigger_per_kelvin = -0.02};
  const Readout warm = sensorAt(fitted, 33).readout, hot = sensorAt(fitted, 50).readout;
  EXPECT_NEAR(warm.taxel_gain[1], std::exp(0.03), 1e-12);
  EXPECT_NEAR(warm.trigger, 0.04, 1e-12);
  EXPECT_NEAR(hot.trigger, -0.3, 1e-12);
}

TEST(Temperature, RefusesHalfOfTheMeasurementsAndFindsNothingAtOne) {
  std::vector<Measurement> some = curves(4, kGain, kTrigger);
  some[1].temperature.reset();
  EXPECT_THAT(support::inputError([&] { characterize(some); }), HasSubstr("curve1.yaml: temperature_degC is missing, curve2.yaml has it"));
  std::vector<Measurement> same = curves(4, 0, 0);
  for (Measurement& measurement : same) measurement.temperature = 31;
  EXPECT_EQ(findEstimate(characterize(same), "temperature.gain"), nullptr);
}

}  // namespace
}  // namespace taxelsim::testing
