// Point spread functions fitted to images under an indenter at known positions, which the reference's stages simulate.
#include "base/philox.h"
#include "characterize/estimates.h"
#include "characterize/footprint.h"
#include "reference/psf.h"
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

constexpr double kPitch = 3.4e-3;

Sensor gridOf(const Psf& psf) {
  Sensor sensor;
  sensor.name = "grid";
  sensor.patches = {{.name = "p", .num_rows = 6, .num_cols = 8, .pitch = {kPitch, kPitch}, .X_SP = {}}};
  sensor.skin.thickness = 2e-3;
  sensor.skin.law = Winkler{.normal_contact_stiffness = 1.73e8};
  sensor.psf = psf;
  sensor.readout.curve = {2000};
  sensor.readout.trigger = 0.02;
  return sensor;
}

struct Series {
  Indenter indenter{.shape = Indenter::Shape::kFlatPin, .radius = 0.5e-3};
  int num_images = 8;
  double force = 1;  // N: maximum; the minimum is half of it
  double noise = 5;  // counts
  std::uint64_t seed = 1;
};

// Force per taxel; for spheres by 400 x 400 points on independent springs, unlike the fit.
std::vector<double> forcesUnder(const Sensor& sensor, const Indenter& indenter, double x, double y, double force) {
  const GridPatch& patch = sensor.patches[0];
  std::vector<double> forces(static_cast<std::size_t>(numTaxels(sensor)));
  if (indenter.shape != Indenter::Shape::kSphere) {
    const Polygon polygon = moved(sectionOf(indenter, 0), {x, y});
    for (int i = 0; i < patch.num_rows; ++i) {
      for (int j = 0; j < patch.num_cols; ++j) {
        const double left = (i - patch.num_rows / 2.0) * kPitch, bottom = (j - patch.num_cols / 2.0) * kPitch;
        forces[static_cast<std::size_t>(i * patch.num_cols + j)] =
            force * overlap(polygon, {left, bottom}, {left + kPitch, bottom + kPitch}) / indenter.sectionAt(0);
      }
    }
    return forces;
  }
  const double stiffness = std::get<Winkler>(sensor.skin.law).normal_contact_stiffness;
  const double depth = std::sqrt(force / (stiffness * std::numbers::pi * indenter.radius)), width = std::sqrt(2 * depth * indenter.radius);
  constexpr int kPoints = 400;
  double total = 0;
  for (int a = 0; a < kPoints; ++a) {
    for (int b = 0; b < kPoints; ++b) {
      const double u = width * (2 * (a + 0.5) / kPoints - 1), v = width * (2 * (b + 0.5) / kPoints - 1);
      const double pressure = std::max(0.0, depth - (u * u + v * v) / (2 * indenter.radius));
      total += pressure;
      const int i = static_cast<int>(std::floor((x + u) / patch.pitch[0] + patch.num_rows / 2.0));
      const int j = static_cast<int>(std::floor((y + v) / patch.pitch[1] + patch.num_cols / 2.0));
      if (i < 0 || i >= patch.num_rows || j < 0 || j >= patch.num_cols) continue;
      forces[static_cast<std::size_t>(i * patch.num_cols + j)] += pressure;
    }
  }
  for (double& value : forces) value *= force / total;
  return forces;
}

PointImages imagesOf(const Sensor& sensor, const Series& series) {
  PointImages points{.indenter = series.indenter, .position = {}, .force = {}, .images = {}};
  points.images.num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  EpisodeRandom random(series.seed, 0);
  for (int n = 0; n < series.num_images; ++n) {
    const double x = kPitch * random.uniform(-3, 3), y = kPitch * random.uniform(-4, 4), force = series.force * random.uniform(0.5, 1);
    const std::vector<double> spread = reference::spread(sensor, forcesUnder(sensor, series.indenter, x, y, force));
    std::vector<double> noise;
    for (std::size_t t = 0; t < spread.size(); ++t) {
      noise.push_back(series.noise * gaussian({.seed = series.seed,
                                               .frame = static_cast<std::uint32_t>(n),
                                               .taxel = static_cast<std::uint32_t>(t),
                                               .purpose = Purpose::kReadoutNoise}));
    }
    points.position.push_back({x, y});
    points.force.push_back(force);
    for (const std::uint32_t counts : reference::readOut(sensor, spread, {.noise = noise})) {
      points.images.counts.push_back(static_cast<float>(counts));
    }
  }
  return points;
}

Characterization fitted(const Sensor& truth, PointImages points) {
  Sensor known = truth;
  known.psf = {};
  const Measurement measurement{
      .file = "points.yaml", .name = "points", .sensor = known, .resolved_sensor = "grid", .data = std::move(points)};
  return characterize(std::span(&measurement, 1));
}

std::string refusal(const Sensor& truth, PointImages points) {
  return support::refusal([&] { fitted(truth, std::move(points)); });
}

TEST(Footprint, OverlapsAddUpToTheSection) {
  const Indenter pin{.shape = Indenter::Shape::kFlatPin, .radius = 2.5e-3};
  const Polygon disc = moved(sectionOf(pin, 0), {0.7e-3, -0.4e-3});
  double sum = 0;
  for (int i = -2; i < 2; ++i) {
    for (int j = -2; j < 2; ++j) sum += overlap(disc, {i * 2e-3, j * 2e-3}, {(i + 1) * 2e-3, (j + 1) * 2e-3});
  }
  EXPECT_NEAR(sum, pin.sectionAt(0), 1e-12);
  // A unit square rotated by 45 degrees has a quarter of its area in a quadrant.
  const Indenter stamp{.shape = Indenter::Shape::kStamp, .size = {1, 1}};
  EXPECT_NEAR(overlap(moved(sectionOf(stamp, 0), {0, 0}, std::numbers::pi / 4), {0, 0}, {2, 2}), 0.25, 1e-12);
  EXPECT_EQ(overlap(disc, {1, 1}, {2, 2}), 0);
}

TEST(Footprint, DepthCarriesTheVolume) {
  const Indenter sphere{.shape = Indenter::Shape::kSphere, .radius = 5e-3};
  const double depth = depthOfVolume(sphere, 1, 1e-9);
  // Volume of a cap: pi d^2 (R - d / 3).
  EXPECT_NEAR(std::numbers::pi * depth * depth * (5e-3 - depth / 3), 1e-9, 1e-14);
}

TEST(PointSpread, FindsSigmaWithRightIntervals) {
  {
    constexpr double sigma = 0.6;
    const Sensor truth = gridOf(gaussianPsf(sigma, 5));
    int inside = 0, other_size = 0;
    for (int run = 0; run < support::kRuns; ++run) {
      const Characterization result = fitted(truth, imagesOf(truth, {.seed = static_cast<std::uint64_t>(run + 1)}));
      inside += holds(result, "psf.gaussian.sigma", sigma);
      other_size += result.sensor.psf.size != truth.psf.size;
    }
    // A free kernel is accepted with a probability of 0.001.
    EXPECT_LE(other_size, 1) << sigma;
    EXPECT_GE(inside, support::kLeastInside) << sigma;
  }
}

TEST(PointSpread, FindsSigmaUnderSpheresAndStamps) {
  const Sensor truth = gridOf(gaussianPsf(0.6, 5));
  for (const Indenter& indenter :
       {Indenter{.shape = Indenter::Shape::kSphere, .radius = 8e-3}, Indenter{.shape = Indenter::Shape::kStamp, .size = {4e-3, 2e-3}}}) {
    const Characterization result = fitted(truth, imagesOf(truth, {.indenter = indenter, .num_images = 30, .force = 3, .seed = 3}));
    const Estimate* const sigma = findEstimate(result, "psf.gaussian.sigma");
    ASSERT_NE(sigma, nullptr);
    EXPECT_NEAR(sigma->value, 0.6, 0.006);
  }
}

TEST(PointSpread, FindsAKernelThatIsNotGaussian) {
  Psf psf{.size = 3, .kernel = {0.03, 0.10, 0.03, 0.05, 0.51, 0.12, 0.03, 0.10, 0.03}};
  Sensor truth = gridOf(psf);
  truth.readout.trigger = 0.005;
  int total = 0;
  for (int run = 0; run < support::kRuns / 4; ++run) {
    const Characterization result = fitted(truth, imagesOf(truth, {.num_images = 30, .seed = static_cast<std::uint64_t>(run + 1)}));
    const int size = result.sensor.psf.size;
    ASSERT_EQ(size, 3);
    for (int k = 0; k < size * size; ++k) {
      const int a = k / size - size / 2, b = k % size - size / 2;
      const double weight = psf.kernel[static_cast<std::size_t>(3 * (a + 1) + b + 1)];
      EXPECT_NEAR(result.sensor.psf.kernel[static_cast<std::size_t>(k)], weight, 0.005);
      total += holds(result, "psf.kernel[" + std::to_string(k / size) + "][" + std::to_string(k % size) + "]", weight);
    }
  }
  // Of 90: P(X <= 76) of a binomial (90, .95) is 2e-4.
  EXPECT_GE(total, 77);
}

TEST(PointSpread, IsRobustToOutliers) {
  const Sensor truth = gridOf(gaussianPsf(0.6, 5));
  PointImages points = imagesOf(truth, {.num_images = 30, .seed = 8});
  for (std::size_t k = 5; k < points.images.counts.size(); k += 37) points.images.counts[k] = k % 2 == 0 ? 2500 : 0;
  const Characterization result = fitted(truth, points);
  EXPECT_NEAR(findEstimate(result, "psf.gaussian.sigma")->value, 0.6, 0.006);
  EXPECT_GT(result.fits.front().num_outliers, 5u);
  EXPECT_EQ(findEstimate(result, "psf.kernel[0][0]"), nullptr);
}

TEST(PointSpread, ClippedReadingsDoNotBiasIt) {
  Sensor truth = gridOf(gaussianPsf(0.6, 5));
  truth.readout.saturation = 700;  // of about 1000 under the pin
  double mean = 0, half = 0;
  constexpr int kSeeds = 6;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Characterization result = fitted(truth, imagesOf(truth, {.noise = 20, .seed = static_cast<std::uint64_t>(seed)}));
    const Estimate* const sigma = findEstimate(result, "psf.gaussian.sigma");
    mean += sigma->value / kSeeds;
    half += (sigma->high - sigma->low) / 2 / kSeeds;
  }
  // The interval of a mean of six is 0.41 of a single one.
  EXPECT_NEAR(mean, 0.6, 0.41 * half);
}

TEST(PointSpread, FindsNoSpreadWhereThereIsNone) {
  const Sensor truth = gridOf({});
  const Characterization result = fitted(truth, imagesOf(truth, {.seed = 4}));
  const Estimate* const sigma = findEstimate(result, "psf.gaussian.sigma");
  ASSERT_NE(sigma, nullptr);
  EXPECT_EQ(sigma->low, 0);
  EXPECT_LT(sigma->high, 0.4);
  EXPECT_THAT(sigma->remark, HasSubstr("no spread"));
}

TEST(PointSpread, NeedsOneImageWithSeveralTaxels) {
  const Sensor truth = gridOf(gaussianPsf(0.6, 5));
  PointImages one = imagesOf(truth, {.num_images = 1, .noise = 1, .seed = 5});
  EXPECT_NEAR(findEstimate(fitted(truth, one), "psf.gaussian.sigma")->value, 0.6, 0.02);

  // All taxels but the brightest are dead: amplitude and spread are confounded.
  Sensor dead = truth;
  const auto brightest =
      static_cast<std::size_t>(std::max_element(one.images.counts.begin(), one.images.counts.end()) - one.images.counts.begin());
  dead.readout.taxel_gain.assign(one.images.num_taxels, 0);
  dead.readout.taxel_gain[brightest] = 1;
  const Characterization result = fitted(dead, one);
  EXPECT_FALSE(findEstimate(result, "psf.gaussian.sigma")->determined);
  EXPECT_EQ(result.sensor.psf.size, 1);
}

TEST(PointSpread, RejectsBadImages) {
  const Sensor truth = gridOf(gaussianPsf(0.6, 5));
  PointImages blank = imagesOf(truth, {.num_images = 3});
  std::fill(blank.images.counts.begin(), blank.images.counts.end(), 0.0f);
  EXPECT_THAT(refusal(truth, blank), HasSubstr("points.yaml: no contact"));
  PointImages off = imagesOf(truth, {.num_images = 3});
  for (auto& position : off.position) position[0] += 1;
  EXPECT_THAT(refusal(truth, off), HasSubstr("points.yaml: the indenter is off the array"));
  Sensor two = truth;
  two.patches.push_back({.name = "q", .num_rows = 1, .num_cols = 1, .pitch = {kPitch, kPitch}, .X_SP = {.position = {0.1, 0, 0}}});
  EXPECT_THAT(refusal(two, off), HasSubstr("points.yaml: point_images and footprint_images need a sensor with one grid"));
  Sensor shallow = truth;
  shallow.readout.saturation = 30;  // of 1000: loaded taxels read 30, others almost 0
  const Characterization clipped = fitted(shallow, imagesOf(shallow, {.num_images = 3}));
  const Estimate* const sigma = findEstimate(clipped, "psf.gaussian.sigma");
  EXPECT_TRUE(!sigma->determined || (sigma->low < 0.6 && 0.6 < sigma->high)) << sigma->low << ' ' << sigma->high;
}

}  // namespace
}  // namespace taxelsim
