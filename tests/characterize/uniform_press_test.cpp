// Gains fitted to presses with a uniform pressure, which the reference's stages simulate with the noise of the sensor, the paper's scatter
// between presses and a scatter per taxel and press.
#include "base/philox.h"
#include "characterize/estimates.h"
#include "characterize/stamp_bench.h"
#include "reference/psf.h"
#include "reference/readout.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {
namespace {

using support::estimateOf;
using support::findEstimate;
using support::holds;
using ::testing::HasSubstr;

constexpr double kPressSpread = 0.174;  // of the paper, figure 6a
constexpr double kTaxelScatter = 0.04;  // docs/notes/validation.md: repeated presses of a real finger
constexpr int kTaxels = 48;

double drawnAs(std::uint64_t seed, std::uint32_t frame, std::uint32_t taxel) {
  return gaussian({.seed = seed, .frame = frame, .taxel = taxel, .purpose = Purpose::kReadoutNoise});
}

Sensor scattered(std::uint64_t seed) {
  Sensor sensor = baseSensor();
  for (std::uint32_t t = 0; t < kTaxels; ++t) sensor.readout.taxel_gain.push_back(std::exp(0.3 * drawnAs(seed, 0, t)));
  return sensor;
}

struct Series {
  int presses = 5, frames = 4;
  double pressure = 3e4;  // Pa
  double noise = 17;      // counts
  std::uint64_t seed = 1;
  bool knows_pressure = true;
};

UniformPress pressed(const Sensor& sensor, const Series& series) {
  UniformPress uniform;
  uniform.images.num_taxels = kTaxels;
  for (int p = 0; p < series.presses; ++p) {
    const auto press = static_cast<std::uint32_t>(1000 * p);
    const double pressure = series.pressure * (1 + 0.2 * p), gain = std::exp(kPressSpread * drawnAs(series.seed + 1, press, 0));
    std::vector<double> force = reference::spread(sensor, std::vector<double>(kTaxels, pressure * gain * kPitch * kPitch));
    for (std::uint32_t t = 0; t < kTaxels; ++t) force[t] *= std::exp(kTaxelScatter * drawnAs(series.seed + 2, press, t));
    for (int f = 0; f < series.frames; ++f) {
      std::vector<double> noise;
      for (std::uint32_t t = 0; t < kTaxels; ++t) {
        noise.push_back(series.noise * drawnAs(series.seed + 3, press + static_cast<std::uint32_t>(f), t));
      }
      for (const std::uint32_t counts : reference::readOut(sensor, force, {.noise = noise})) {
        uniform.images.counts.push_back(static_cast<float>(counts));
      }
      uniform.press.push_back(p);
      if (series.knows_pressure) uniform.pressure.push_back(pressure);
    }
  }
  return uniform;
}

Measurement measurementOf(const Sensor& truth, UniformPress uniform) {
  Sensor known = truth;
  known.readout.taxel_gain.clear();
  return {.file = "air.yaml", .name = "air", .sensor = known, .resolved_sensor = "s", .data = std::move(uniform)};
}

Characterization fittedTo(const Sensor& truth, UniformPress uniform) {
  const Measurement measurement = measurementOf(truth, std::move(uniform));
  return characterize(std::span(&measurement, 1));
}

std::string refusal(const Sensor& truth, UniformPress uniform) {
  return support::refusal([&] { fittedTo(truth, std::move(uniform)); });
}

class UniformPresses : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Numbers, UniformPresses, ::testing::Values(1, 5));

TEST_P(UniformPresses, FindGainsWithRightIntervals) {
  constexpr int kBenches = 20;
  int inside = 0, spreads = 0;
  double squares = 0;
  for (int run = 0; run < kBenches; ++run) {
    const std::uint64_t seed = 10 * static_cast<std::uint64_t>(run + 1);
    const Sensor truth = scattered(seed);
    double mean = 0;
    for (const double gain : truth.readout.taxel_gain) mean += gain / kTaxels;
    const Characterization result = fittedTo(truth, pressed(truth, {.presses = GetParam(), .seed = seed}));
    for (std::size_t t = 0; t < kTaxels; ++t) {
      const double gain = truth.readout.taxel_gain[t] / mean;
      inside += holds(result, "readout.taxel_gain[" + std::to_string(t) + "]", gain);
      squares += std::pow(std::log(result.sensor.readout.taxel_gain[t] / gain), 2);
    }
    spreads += holds(result, "readout.press_gain_spread", kPressSpread);
  }
  // Four standard deviations of binomials (960, .95) and (20, .95); the gains of one bench share their mean and the estimate of the noise.
  EXPECT_GE(inside, 885);
  EXPECT_LE(inside, 939) << "intervals are too wide";
  EXPECT_GE(spreads, GetParam() > 1 ? 15 : 0);
  // 4 % in five presses is 1.8 %; 17 counts of about 700 in four frames add 0.5 %. In one press: 4 and 1.2 %.
  EXPECT_LT(std::sqrt(squares / (kBenches * kTaxels)), GetParam() > 1 ? 0.025 : 0.045);
}

TEST(UniformPress, FindsDeadAndSilentTaxels) {
  Sensor truth = scattered(3);
  truth.readout.taxel_gain[7] = 0;
  UniformPress uniform = pressed(truth, {.presses = 3});
  for (std::size_t row = 0; row < uniform.press.size(); ++row) uniform.images.counts[row * kTaxels + 9] = 4095;
  for (std::size_t row = 0; row < uniform.press.size(); ++row) uniform.images.counts[row * kTaxels + 7] = 0;
  const Characterization result = fittedTo(truth, uniform);
  EXPECT_THAT(result.dead_taxels, ::testing::ElementsAre(7));
  EXPECT_EQ(result.sensor.readout.taxel_gain[7], 0);
  EXPECT_EQ(result.sensor.readout.taxel_gain[9], 1) << "saturated";
  EXPECT_EQ(findEstimate(result, "readout.taxel_gain[9]"), nullptr);
  EXPECT_THAT(result.remarks, ::testing::Contains(HasSubstr("1 taxels read 0 or are saturated")));
}

TEST(UniformPress, IsRobustToOutliers) {
  const Sensor truth = scattered(4);
  UniformPress uniform = pressed(truth, {.presses = 8, .frames = 1, .seed = 4});
  for (std::size_t k = 3; k < uniform.images.counts.size(); k += 61) uniform.images.counts[k] = 3000;
  double mean = 0;
  for (const double gain : truth.readout.taxel_gain) mean += gain / kTaxels;
  const Characterization result = fittedTo(truth, uniform);
  EXPECT_GE(result.fits.front().num_outliers, 5u);
  // 4 % and 17 counts of 700 in eight presses: 1.7 %; four times that.
  for (std::size_t t = 0; t < kTaxels; ++t) {
    EXPECT_NEAR(result.sensor.readout.taxel_gain[t] * mean / truth.readout.taxel_gain[t], 1, 0.07) << t;
  }
}

// Stamps keep the gains of a uniform press: with one fixture alone, spread and gains look alike.
TEST(UniformPress, GivesStampsTheirGains) {
  const Sensor truth = scattered(5);
  std::vector<StampImages> stamps;
  for (int n = 0; n < 8; ++n) {
    stamps.push_back(recorded(truth, {.load = 3.0 + n / 2, .x = 0.6e-3, .seed = 60 + static_cast<std::uint64_t>(n)}));
    stamps.back().fixture = "holder";
  }
  std::vector<Measurement> measurements = measured(truth, stamps);
  const double without = std::abs(estimateOf(characterize(measurements), "psf.gaussian.sigma").value - 0.6);
  measurements.push_back(measurementOf(truth, pressed(truth, {.presses = 8, .seed = 5})));
  measurements.back().sensor.psf = {};
  const Characterization result = characterize(measurements);
  EXPECT_LT(std::abs(estimateOf(result, "psf.gaussian.sigma").value - 0.6), 0.02);
  EXPECT_GT(without, 0.02) << "stamps alone do not separate spread and gains";
  for (std::size_t t = 0; t < kTaxels; ++t) EXPECT_GT(result.sensor.readout.taxel_gain[t], 0.3) << t;
}

TEST(UniformPress, RefusesWhatGivesNoGains) {
  const Sensor truth = scattered(6);
  EXPECT_THAT(refusal(truth, pressed(truth, {.presses = 1, .pressure = 10, .noise = 0})),
              HasSubstr("air.yaml: 0 taxels read between 0 and saturation, at least two are needed"));
  EXPECT_THAT(refusal(truth, pressed(truth, {.pressure = 10, .noise = 0})), HasSubstr("air.yaml: 0 taxels read between 0 and saturation"));
}

}  // namespace
}  // namespace taxelsim::testing
