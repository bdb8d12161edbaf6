// Parameters fitted to recordings under a flat stamp, which the reference's stages simulate.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "base/philox.h"
#include "characterize/estimates.h"
#include "characterize/footprint.h"
#include "reference/frame.h"
#include "reference/lag.h"
#include "reference/psf.h"
#include "reference/readout.h"
#include "taxelsim/characterize.h"
#include "taxelsim/error.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

using support::findEstimate;
using support::holds;
using ::testing::HasSubstr;

constexpr double kPitch = 3.4e-3, kFrame = 0.1;

Sensor baseSensor() {
  Sensor sensor;
  sensor.name = "stamped";
  sensor.patches = {{.name = "p", .num_rows = 6, .num_cols = 8, .pitch = {kPitch, kPitch}, .X_SP = {}}};
  sensor.skin.thickness = 2e-3;
  sensor.skin.law = Winkler{.normal_contact_stiffness = 1.73e8};
  sensor.psf = gaussianPsf(0.6, 5);
  sensor.readout.curve = {2000};
  sensor.readout.trigger = 0.03;
  sensor.readout.creep = {{.fraction = 0.2, .time = 3}};
  return sensor;
}

// 6 taxels along x over a cylinder about y, in rows of 5.
Sensor curvedSensor(double radius) {
  Sensor sensor = baseSensor();
  sensor.name = "curved";
  sensor.patches.clear();
  sensor.samples_per_taxel = 8;
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j < 6; ++j) {
      const double angle = (i - 3) * kPitch / radius;
      const Vector3 normal{std::sin(angle), 0, std::cos(angle)};
      sensor.patches.push_back(taxelPatch("t" + std::to_string(i) + "_" + std::to_string(j),
                                          {radius * normal[0], (j - 2.5) * kPitch, radius * (normal[2] - 1)}, normal, {kPitch, kPitch}));
    }
  }
  sensor.psf = {.size = 1, .kernel = {1}, .sigma = 0.6 * kPitch, .reach = 0};
  return sensor;
}

struct Press {
  double load = 5;  // N
  double x = 0, y = 0, yaw = 0;
  double gain = 1;   // of all taxels
  double noise = 5;  // counts
  std::uint64_t seed = 1;
};

const Indenter kStamp{.shape = Indenter::Shape::kStamp, .size = {10.5e-3, 10.5e-3}};

// Forces of a rigid box that lies on the skin.
std::vector<double> forcesUnder(const Sensor& sensor, const Press& press) {
  if (sensor.patches.size() == 1) {
    const GridPatch& patch = sensor.patches[0];
    const Polygon polygon = moved(sectionOf(kStamp, 0), {press.x, press.y}, press.yaw);
    std::vector<double> forces;
    for (int i = 0; i < patch.num_rows; ++i) {
      for (int j = 0; j < patch.num_cols; ++j) {
        const double left = (i - patch.num_rows / 2.0) * kPitch, bottom = (j - patch.num_cols / 2.0) * kPitch;
        forces.push_back(press.load * overlap(polygon, {left, bottom}, {left + kPitch, bottom + kPitch}) / kStamp.sectionAt(0));
      }
    }
    return forces;
  }
  const Object box("box", Box{{kStamp.size[0], kStamp.size[1], 5e-3}});
  const Pose pose{.position = {press.x, press.y, 2.5e-3}, .rotation = axisAngle({0, 0, 1}, press.yaw)};
  reference::FrameInput input;
  input.objects = {{&box, pose}};
  input.load = press.load;
  return reference::simulateFrame(sensor, input).taxel_force;
}

StampImages recorded(const Sensor& sensor, const Press& press) {
  StampImages stamp{.indenter = kStamp, .load = press.load, .images = {}};
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  stamp.images.num_taxels = num_taxels;
  std::vector<double> spread = reference::spread(sensor, forcesUnder(sensor, press));
  for (double& force : spread) force *= press.gain;
  reference::Lag lag(sensor.readout, num_taxels);
  for (int frame = 1; frame <= 100; ++frame) {
    std::vector<double> read;
    for (const double share : {0.5, 0.5}) {
      const bool on = frame > 10 || (frame == 10 && !read.empty());
      read = lag.step(on ? spread : std::vector<double>(num_taxels), kFrame * share);
    }
    std::vector<double> noise;
    for (std::size_t t = 0; t < num_taxels; ++t) {
      noise.push_back(press.noise * gaussian({.seed = press.seed,
                                              .frame = static_cast<std::uint32_t>(frame),
                                              .taxel = static_cast<std::uint32_t>(t),
                                              .purpose = Purpose::kReadoutNoise}));
    }
    stamp.images.time.push_back(frame * kFrame);
    for (const std::uint32_t counts : reference::readOut(sensor, read, {.noise = noise})) {
      stamp.images.counts.push_back(static_cast<float>(counts));
    }
  }
  return stamp;
}

Characterization fitted(const Sensor& truth, const std::vector<StampImages>& stamps) {
  Sensor known = truth;
  known.psf = {};
  known.readout.curve = {1};
  known.readout.trigger = 0;
  known.readout.creep.clear();
  known.readout.taxel_gain.clear();
  std::vector<Measurement> measurements;
  for (const StampImages& stamp : stamps) {
    const std::string name = "stamp" + std::to_string(measurements.size());
    measurements.push_back({.file = name + ".yaml", .name = name, .sensor = known, .resolved_sensor = "s", .data = stamp});
  }
  return characterize(measurements);
}

std::string refusal(const Sensor& truth, const StampImages& stamp) {
  try {
    fitted(truth, {stamp});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::vector<Press> drawn(std::uint64_t seed, int count) {
  EpisodeRandom random(seed, 0);
  std::vector<Press> presses;
  for (int n = 0; n < count; ++n) {
    presses.push_back({.load = random.uniform(3, 9),
                       .x = random.uniform(-3e-3, 3e-3),
                       .y = random.uniform(-5e-3, 5e-3),
                       .yaw = random.uniform(-0.2, 0.2),
                       .seed = 100 * seed + static_cast<std::uint64_t>(n)});
  }
  return presses;
}

std::vector<StampImages> recordedAll(const Sensor& sensor, const std::vector<Press>& presses) {
  std::vector<StampImages> stamps;
  for (const Press& press : presses) stamps.push_back(recorded(sensor, press));
  return stamps;
}

TEST(StampImages, FindsAllParametersWithRightIntervals) {
  const Sensor truth = baseSensor();
  int sigma = 0, scale = 0, trigger = 0, fraction = 0, place = 0;
  for (int run = 0; run < 20; ++run) {
    const std::vector<Press> presses = drawn(static_cast<std::uint64_t>(run + 1), 3);
    const Characterization result = fitted(truth, recordedAll(truth, presses));
    sigma += holds(result, "psf.gaussian.sigma", 0.6);
    scale += holds(result, "readout.curve.counts_per_newton", 2000);
    trigger += holds(result, "readout.trigger", 0.03);
    fraction += holds(result, "readout.creep[0].fraction", 0.2);
    place +=
        holds(result, "stamp1.x", presses[1].x) + holds(result, "stamp1.y", presses[1].y) + holds(result, "stamp1.yaw", presses[1].yaw);
  }
  // Of 20: P(X <= 15) of a binomial (20, .95) is .003; of 60: P(X <= 51) is .003.
  EXPECT_GE(sigma, 16);
  EXPECT_GE(scale, 16);
  EXPECT_GE(trigger, 16);
  EXPECT_GE(fraction, 16);
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
}  // namespace taxelsim
