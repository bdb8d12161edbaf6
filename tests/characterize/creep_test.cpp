// Creep fitted to step responses that the reference's readout simulates.
#include "base/philox.h"
#include "characterize/estimates.h"
#include "reference/lag.h"
#include "reference/readout.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/characterize.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using support::findEstimate;
using support::holds;
using ::testing::HasSubstr;

constexpr double kFrame = 1.0 / 31;

Sensor oneTaxel(std::vector<CreepTerm> creep) {
  Sensor sensor;
  sensor.name = "one taxel";
  sensor.patches = {{.name = "p", .num_rows = 1, .num_cols = 1, .pitch = {3.4e-3, 3.4e-3}, .X_SP = {}}};
  sensor.skin.thickness = 2e-3;
  sensor.skin.law = Winkler{.normal_contact_stiffness = 1.73e8};
  sensor.readout.curve = {2000};
  sensor.readout.creep = std::move(creep);
  return sensor;
}

struct Recording {
  double load = 1;          // N
  double seconds = 12;      // duration
  double rise = 0;          // s
  double noise = 5;         // counts
  double noise_memory = 0;  // correlation from row to row
  double lift_after = 1e9;  // s after the onset
  std::uint64_t seed = 1;
};

// The onset is 1 s after the start, between two frames.
StepResponse recorded(const Sensor& sensor, const Recording& how) {
  StepResponse step{.load = how.load, .time = {}, .counts = {}};
  reference::Lag lag(sensor.readout, 1);
  const double onset = 1 + kFrame * uniformNumber({.seed = how.seed, .purpose = Purpose::kEpisode});
  const auto force = [&](double t) {
    if (t < onset || t > onset + how.lift_after) return 0.0;
    return how.rise > 0 ? how.load * std::min(1.0, (t - onset) / how.rise) : how.load;
  };
  constexpr int kSubsteps = 50;
  double noise = 0;
  const int num_frames = static_cast<int>(how.seconds / kFrame);
  for (int frame = 1; frame <= num_frames; ++frame) {
    std::vector<double> read(1);
    for (int k = 0; k < kSubsteps; ++k) {
      const double t = (frame - 1 + (k + 0.5) / kSubsteps) * kFrame;
      read = lag.step(std::vector<double>{force(t)}, kFrame / kSubsteps);
    }
    const double fresh = gaussian({.seed = how.seed, .frame = static_cast<std::uint32_t>(frame), .purpose = Purpose::kReadoutNoise});
    noise = how.noise_memory * noise + std::sqrt(1 - how.noise_memory * how.noise_memory) * how.noise * fresh;
    step.time.push_back(frame * kFrame);
    step.counts.push_back(reference::readOut(sensor, read, {.noise = {noise}})[0]);
  }
  return step;
}

Measurement measured(const Sensor& known, StepResponse step, const std::string& name = "step") {
  return {.file = name + ".yaml", .name = name, .sensor = known, .resolved_sensor = known.name, .data = std::move(step)};
}

Characterization fitted(const Sensor& truth, const std::vector<Recording>& recordings) {
  Sensor known = truth;
  known.readout.creep.clear();
  std::vector<Measurement> measurements;
  for (const Recording& how : recordings) measurements.push_back(measured(known, recorded(truth, how)));
  return characterize(measurements);
}

std::string refusal(const Sensor& sensor, StepResponse step) {
  return support::refusal([&] {
    const Measurement measurement = measured(sensor, std::move(step));
    characterize(std::span(&measurement, 1));
  });
}

TEST(Creep, FindsTwoTermsWithRightIntervals) {
  const Sensor truth = oneTaxel({{.fraction = 0.15, .time = 0.5}, {.fraction = 0.2, .time = 5}});
  int inside[4] = {0, 0, 0, 0};
  for (int run = 0; run < support::kRuns; ++run) {
    const auto seed = static_cast<std::uint64_t>(2 * run + 1);
    const Characterization result = fitted(truth, {{.load = 1, .seed = seed}, {.load = 0.7, .seconds = 14, .seed = seed + 1}});
    inside[0] += holds(result, "readout.creep[0].fraction", 0.15);
    inside[1] += holds(result, "readout.creep[0].time", 0.5);
    inside[2] += holds(result, "readout.creep[1].fraction", 0.2);
    inside[3] += holds(result, "readout.creep[1].time", 5);
    ASSERT_EQ(result.sensor.readout.creep.size(), 2u) << run;
  }
  for (const int count : inside) EXPECT_GE(count, support::kLeastInside);
}

TEST(Creep, IntervalsHoldForAutocorrelatedNoise) {
  const Sensor truth = oneTaxel({{.fraction = 0.3, .time = 2}});
  int inside[2] = {0, 0}, more = 0;
  for (int run = 0; run < support::kRuns; ++run) {
    const Characterization result = fitted(truth, {{.noise = 15, .noise_memory = 0.8, .seed = static_cast<std::uint64_t>(run + 1)}});
    inside[0] += holds(result, "readout.creep[0].fraction", 0.3);
    inside[1] += holds(result, "readout.creep[0].time", 2);
    more += result.sensor.readout.creep.size() > 1;
  }
  EXPECT_GE(inside[0], support::kLeastInside);
  EXPECT_GE(inside[1], support::kLeastInside);
  EXPECT_LE(more, 2);
}

TEST(Creep, DoesNotSplitASingleTerm) {
  const Sensor truth = oneTaxel({{.fraction = 0.3, .time = 2}});
  int more = 0;
  for (int run = 0; run < support::kRuns; ++run) {
    const Characterization result = fitted(truth, {{.seed = static_cast<std::uint64_t>(run + 1)}});
    more += result.sensor.readout.creep.size() > 1;
    const Estimate* const further = findEstimate(result, "readout.creep[1]");
    EXPECT_TRUE(further == nullptr || !further->determined);
  }
  // False positives have a probability of 0.001.
  EXPECT_LE(more, 1);
}

TEST(Creep, SlowRiseIsNotFittedAsCreep) {
  const Sensor still = oneTaxel({});
  const Characterization none = fitted(still, {{.rise = 0.4, .seed = 5}});
  EXPECT_TRUE(none.sensor.readout.creep.empty());
  ASSERT_NE(findEstimate(none, "readout.creep[0]"), nullptr);
  EXPECT_THAT(findEstimate(none, "readout.creep[0]")->remark, HasSubstr("no creep"));

  const Characterization slow = fitted(oneTaxel({{.fraction = 0.3, .time = 2}}), {{.rise = 0.4, .seed = 6}, {.rise = 0.3, .seed = 7}});
  EXPECT_TRUE(holds(slow, "readout.creep[0].fraction", 0.3));
  EXPECT_TRUE(holds(slow, "readout.creep[0].time", 2));
}

TEST(Creep, TriggerOfOneTaxelDoesNotBiasFractions) {
  Sensor truth = oneTaxel({{.fraction = 0.3, .time = 2}});
  truth.readout.trigger = 0.3;  // of 1 N: without correction the fraction would be 0.43
  EXPECT_TRUE(holds(fitted(truth, {{.seed = 3}}), "readout.creep[0].fraction", 0.3));
}

TEST(Creep, SumOverTaxelsRemarksOnTriggers) {
  Sensor truth = oneTaxel({{.fraction = 0.3, .time = 2}});
  truth.readout.trigger = 0.02;
  StepResponse step = recorded(truth, {.load = 1, .noise = 1, .seed = 3});
  for (double& counts : step.counts) counts *= 12;
  Sensor known = truth;
  known.readout.creep.clear();
  const Measurement measurement = measured(known, step);
  const Characterization result = characterize(std::span(&measurement, 1));
  const Estimate* const fraction = findEstimate(result, "readout.creep[0].fraction");
  ASSERT_NE(fraction, nullptr);
  EXPECT_THAT(fraction->remark, HasSubstr("each active taxel"));
  EXPECT_NEAR(fraction->value, 0.3 * 1 / (1 - 0.02), 0.005);
}

TEST(Creep, IgnoresOutliersAndUnloading) {
  const Sensor truth = oneTaxel({{.fraction = 0.3, .time = 2}});
  StepResponse step = recorded(truth, {.seconds = 14, .lift_after = 11, .seed = 9});
  for (std::size_t r = 60; r < step.counts.size(); r += 23) step.counts[r] = r % 2 == 0 ? 4000 : 1200;
  Sensor known = truth;
  known.readout.creep.clear();
  const Measurement measurement = measured(known, step);
  const Characterization result = characterize(std::span(&measurement, 1));
  ASSERT_EQ(result.sensor.readout.creep.size(), 1u);
  EXPECT_NEAR(result.sensor.readout.creep[0].fraction, 0.3, 0.006);
  EXPECT_NEAR(result.sensor.readout.creep[0].time, 2, 0.03);
  EXPECT_GE(result.fits.front().num_outliers, 10u);
}

TEST(Creep, DoesNotDetermineTermsSlowerThanTheRecording) {
  const Sensor truth = oneTaxel({{.fraction = 2, .time = 100}});
  const Characterization result = fitted(truth, {{.load = 0.5, .seed = 4}});
  const Estimate* const term = findEstimate(result, "readout.creep[0]");
  ASSERT_NE(term, nullptr);
  EXPECT_FALSE(term->determined);
  EXPECT_THAT(term->remark, HasSubstr("time constant longer than the"));
  EXPECT_TRUE(result.sensor.readout.creep.empty());
}

TEST(Creep, RejectsBadRecordings) {
  const Sensor sensor = oneTaxel({{.fraction = 0.3, .time = 2}});
  const StepResponse good = recorded(sensor, {});
  const auto cut = [&](std::size_t first, std::size_t end) {
    StepResponse part{.load = 1, .time = {}, .counts = {}};
    part.time.assign(good.time.begin() + static_cast<std::ptrdiff_t>(first), good.time.begin() + static_cast<std::ptrdiff_t>(end));
    part.counts.assign(good.counts.begin() + static_cast<std::ptrdiff_t>(first), good.counts.begin() + static_cast<std::ptrdiff_t>(end));
    return part;
  };
  EXPECT_THAT(refusal(sensor, cut(0, 20)), HasSubstr("step.yaml: no contact"));
  EXPECT_THAT(refusal(sensor, cut(0, 1)), HasSubstr("step.yaml: no contact"));
  EXPECT_THAT(refusal(sensor, cut(60, 300)), HasSubstr("begins under load"));
  EXPECT_THAT(refusal(sensor, cut(60, 61)), HasSubstr("step.yaml: "));
  EXPECT_THAT(refusal(sensor, cut(0, 37)), HasSubstr("full load found, at least"));
  StepResponse twice = good;
  for (std::size_t r = 100; r < 200; ++r) twice.counts[r] = 0;
  EXPECT_THAT(refusal(sensor, twice), HasSubstr("does not rise once"));
  StepResponse clipped = good;
  for (double& counts : clipped.counts) counts = counts > 100 ? 4095 : 0;
  EXPECT_THAT(refusal(sensor, clipped), HasSubstr("most rows are saturated"));
}

}  // namespace
}  // namespace taxelsim
