// Parameters fitted to recordings under a flat stamp, which the reference's stages simulate.
#include "characterize/estimates.h"
#include "characterize/stamp_bench.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {
namespace {

using support::findEstimate;
using support::holds;
using ::testing::HasSubstr;

std::string refusal(const Sensor& truth, const StampImages& stamp) {
  return support::refusal([&] { fitted(truth, {stamp}); });
}

TEST(StampImages, FindsAllParametersWithRightIntervals) {
  const Sensor truth = baseSensor();
  int sigma = 0, scale = 0, trigger = 0, fraction = 0, noise = 0, place = 0;
  for (int run = 0; run < 20; ++run) {
    const std::vector<Press> presses = drawn(static_cast<std::uint64_t>(run + 1), 3);
    const Characterization result = fitted(truth, recordedAll(truth, presses));
    sigma += holds(result, "psf.gaussian.sigma", 0.6);
    scale += holds(result, "readout.curve.counts_per_newton", 2000);
    trigger += holds(result, "readout.trigger", 0.03);
    fraction += holds(result, "readout.creep[0].fraction", 0.2);
    noise += holds(result, "readout.noise", presses[0].noise);
    EXPECT_NEAR(result.sensor.readout.noise, presses[0].noise, 1) << "counts";
    place +=
        holds(result, "stamp1.x", presses[1].x) + holds(result, "stamp1.y", presses[1].y) + holds(result, "stamp1.yaw", presses[1].yaw);
  }
  // Of 20: P(X <= 15) of a binomial (20, .95) is .003; of 60: P(X <= 51) is .003.
  EXPECT_GE(sigma, 16);
  EXPECT_GE(scale, 16);
  EXPECT_GE(trigger, 16);
  EXPECT_GE(fraction, 16);
  EXPECT_GE(noise, 16);
  EXPECT_GE(place, 52);
}

TEST(StampImages, FindsGainsOfLoadedTaxels) {
  Sensor truth = baseSensor();
  EpisodeRandom random(5, 0);
  for (int t = 0; t < 48; ++t) truth.readout.taxel_gain.push_back(random.uniform(0.85, 1.15));
  std::vector<Press> presses = drawn(7, 16);
  for (Press& press : presses) press.y = -std::abs(press.y);
  const Characterization result = fitted(truth, recordedAll(truth, presses));
  std::vector<std::size_t> fitted;
  double mean = 0;
  for (std::size_t t = 0; t < 48; ++t) {
    if (findEstimate(result, "readout.taxel_gain[" + std::to_string(t) + "]") != nullptr) fitted.push_back(t);
  }
  ASSERT_GE(fitted.size(), 25u);
  for (const std::size_t t : fitted) mean += truth.readout.taxel_gain[t] / static_cast<double>(fitted.size());
  double before = 0, after = 0;
  int held = 0;
  for (const std::size_t t : fitted) {
    const double gain = truth.readout.taxel_gain[t] / mean;
    const Estimate& estimate = support::estimateOf(result, "readout.taxel_gain[" + std::to_string(t) + "]");
    held += holds(estimate, gain);
    if (estimate.high - estimate.low > 0.1) continue;  // hardly loaded
    before += std::pow(gain - 1, 2);
    after += std::pow(estimate.value - gain, 2);
  }
  EXPECT_LT(after, before / 20);
  // P(X <= n - 6) of a binomial (n, .95) is below .01 for n of 25 to 48; errors of neighbours are correlated, and all depend on one mean.
  EXPECT_GE(held, static_cast<int>(fitted.size()) - 5);
  EXPECT_THAT(result.remarks, ::testing::Contains(HasSubstr("taxels were never loaded")));
}

TEST(StampImages, SeparatesPressGainsFromNoise) {
  const Sensor truth = baseSensor();
  std::vector<Press> presses = drawn(3, 8);
  for (std::size_t n = 0; n < presses.size(); ++n) presses[n].gain = n % 2 == 0 ? 1.08 : 0.92;
  const Characterization result = fitted(truth, recordedAll(truth, presses));
  const Estimate* const spread = findEstimate(result, "readout.press_gain_spread");
  ASSERT_NE(spread, nullptr);
  EXPECT_NEAR(spread->value, 0.0855, 0.03);  // of +-0.08 over 8
  EXPECT_TRUE(holds(result, "readout.curve.counts_per_newton", 2000));
  EXPECT_EQ(findEstimate(fitted(truth, recordedAll(truth, drawn(3, 8))), "readout.press_gain_spread"), nullptr);
}

TEST(StampImages, FindsACurveThatBends) {
  Sensor truth = baseSensor();
  truth.readout.curve_limit = 6000;
  const Characterization result = fitted(truth, recordedAll(truth, drawn(6, 8)));
  EXPECT_TRUE(holds(result, "readout.curve.limit", 6000)) << support::estimateOf(result, "readout.curve.limit").value;
  EXPECT_TRUE(holds(result, "readout.curve.counts_per_newton", 2000));
  EXPECT_TRUE(holds(result, "readout.creep[0].fraction", 0.2));
  EXPECT_EQ(findEstimate(fitted(baseSensor(), recordedAll(baseSensor(), drawn(6, 8))), "readout.curve.limit"), nullptr);
}

TEST(StampImages, FindsTheStiffnessOfACurvedSkin) {
  const Sensor truth = curvedSensor(30e-3);
  std::vector<Press> presses = drawn(9, 4);
  for (Press& press : presses) press.y /= 2, press.x /= 3;
  const Characterization result = fitted(truth, recordedAll(truth, presses));
  // The box is sampled 8 x 8 times per taxel, the fit uses covered areas: a few per cent at edges.
  EXPECT_NEAR(findEstimate(result, "psf.skin_gaussian.sigma")->value, 0.6 * kPitch, 0.03 * kPitch);
  EXPECT_NEAR(findEstimate(result, "readout.curve.counts_per_newton")->value, 2000, 40);
  EXPECT_NEAR(findEstimate(result, "skin.normal_contact_stiffness")->value, 1.73e8, 0.2e8);
}

TEST(StampImages, IsRobustToOutliers) {
  const Sensor truth = baseSensor();
  std::vector<StampImages> stamps = recordedAll(truth, drawn(4, 4));
  for (StampImages& stamp : stamps) {
    for (std::size_t row = 0; row < 100; ++row) stamp.images.counts[row * 48 + 7] = row > 12 ? 3000 : 0;
    stamp.images.counts[60 * 48 + 20] = 0;  // one frame
  }
  const Characterization result = fitted(truth, stamps);
  EXPECT_NEAR(findEstimate(result, "psf.gaussian.sigma")->value, 0.6, 0.02);
  EXPECT_NEAR(findEstimate(result, "readout.curve.counts_per_newton")->value, 2000, 40);
}

TEST(StampImages, RejectsBadRecordings) {
  const Sensor truth = baseSensor();
  const StampImages good = recorded(truth, {});
  StampImages blank = good;
  std::fill(blank.images.counts.begin(), blank.images.counts.end(), 0.0f);
  EXPECT_THAT(refusal(truth, blank), HasSubstr("stamp0.yaml: no contact"));
  StampImages brief = good;
  brief.images.time.resize(40), brief.images.counts.resize(40 * 48);
  EXPECT_THAT(refusal(truth, brief), HasSubstr("stamp0.yaml: no frame under load from 4.5 to 5.5 s"));
  StampImages row = good;
  row.images.time.resize(1), row.images.counts.resize(48);
  EXPECT_THAT(refusal(truth, row), HasSubstr("stamp0.yaml: "));
  StampImages late = good;
  late.images.time.erase(late.images.time.begin(), late.images.time.begin() + 20);
  late.images.counts.erase(late.images.counts.begin(), late.images.counts.begin() + 20 * 48);
  EXPECT_THAT(refusal(truth, late), HasSubstr("begins under load"));
}

}  // namespace
}  // namespace taxelsim::testing
