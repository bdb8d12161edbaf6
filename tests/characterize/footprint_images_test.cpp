// Point spread functions fitted to images of footprints: a mask of high resolution or a turned stamp, at places known exactly or with an
// error. The reference's stages simulate the images.
#include "base/philox.h"
#include "characterize/estimates.h"
#include "characterize/footprint.h"
#include "characterize/stamp_bench.h"
#include "reference/psf.h"
#include "reference/readout.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {
namespace {

using support::estimateOf;
using support::findEstimate;
using support::holds;
using ::testing::HasSubstr;

constexpr double kPixel = 0.2e-3, kSigma = 0.6;

// An L of 8 x 6 mm with bars of 2 mm.
FootprintMask letterL() {
  FootprintMask mask{.num_rows = 40, .num_cols = 30, .pixel = kPixel, .pressure = std::vector<float>(40 * 30)};
  for (std::size_t i = 0; i < 40; ++i) {
    for (std::size_t j = 0; j < 30; ++j) mask.pressure[i * 30 + j] = i < 10 || j < 10 ? 1 : 0;
  }
  return mask;
}

struct Place {
  double x = 0, y = 0, yaw = 0;
};

// Force on each taxel, by 5 x 5 points in each pixel, unlike the fit.
std::vector<double> forcesUnder(const Sensor& sensor, const FootprintMask& mask, const Place& place, double force) {
  const GridPatch& patch = sensor.patches[0];
  std::vector<double> forces(static_cast<std::size_t>(numTaxels(sensor)));
  double total = 0;
  constexpr int kPoints = 5;
  for (std::size_t p = 0; p < mask.pressure.size(); ++p) {
    for (int k = 0; k < kPoints * kPoints && mask.pressure[p] > 0; ++k) {
      const double u =
          (static_cast<double>(p / mask.num_cols) + (k / kPoints + 0.5) / kPoints - static_cast<double>(mask.num_rows) / 2) * mask.pixel;
      const double v =
          (static_cast<double>(p % mask.num_cols) + (k % kPoints + 0.5) / kPoints - static_cast<double>(mask.num_cols) / 2) * mask.pixel;
      const double x = place.x + std::cos(place.yaw) * u - std::sin(place.yaw) * v,
                   y = place.y + std::sin(place.yaw) * u + std::cos(place.yaw) * v;
      const int i = static_cast<int>(std::floor(x / patch.pitch[0] + patch.num_rows / 2.0)),
                j = static_cast<int>(std::floor(y / patch.pitch[1] + patch.num_cols / 2.0));
      total += mask.pressure[p];
      if (i >= 0 && i < patch.num_rows && j >= 0 && j < patch.num_cols)
        forces[static_cast<std::size_t>(i * patch.num_cols + j)] += mask.pressure[p];
    }
  }
  for (double& value : forces) value *= force / total;
  return forces;
}

struct Series {
  int images = 6;
  double noise = 5;           // counts
  double position_error = 0;  // m
  std::uint64_t seed = 1;
};

// Footprints at random places; the recorded ones are off by the position error.
PointImages footprints(const Sensor& sensor, const Series& series) {
  PointImages points{.indenter = {}, .position = {}, .force = {}, .images = {}, .mask = letterL(), .position_error = series.position_error};
  points.images.num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  EpisodeRandom random(series.seed, 0);
  const auto normal = [&](int n, std::uint32_t t) {
    return gaussian({.seed = series.seed, .frame = static_cast<std::uint32_t>(n), .taxel = t, .purpose = Purpose::kReadoutNoise});
  };
  for (int n = 0; n < series.images; ++n) {
    const Place place{random.uniform(-3e-3, 3e-3), random.uniform(-6e-3, 6e-3), random.uniform(-0.6, 0.6)};
    const std::vector<double> spread = reference::spread(sensor, forcesUnder(sensor, *points.mask, place, random.uniform(3, 6)));
    std::vector<double> noise;
    for (std::uint32_t t = 0; t < spread.size(); ++t) noise.push_back(series.noise * normal(n, t));
    points.position.push_back({place.x + series.position_error * normal(n, 1000), place.y + series.position_error * normal(n, 1001)});
    points.yaw.push_back(place.yaw);
    for (const std::uint32_t counts : reference::readOut(sensor, spread, {.noise = noise}))
      points.images.counts.push_back(static_cast<float>(counts));
  }
  return points;
}

Characterization fittedTo(const Sensor& truth, PointImages points) {
  Sensor known = truth;
  known.psf = {};
  const Measurement measurement{.file = "film.yaml", .name = "film", .sensor = known, .resolved_sensor = "s", .data = std::move(points)};
  return characterize(std::span(&measurement, 1));
}

TEST(FootprintImages, FindSigmaWithRightIntervals) {
  const Sensor truth = baseSensor();
  constexpr int kBenches = 12;
  int inside = 0;
  for (int run = 0; run < kBenches; ++run) {
    const Characterization result = fittedTo(truth, footprints(truth, {.seed = static_cast<std::uint64_t>(run + 1)}));
    inside += holds(result, "psf.gaussian.sigma", kSigma);
    EXPECT_NEAR(estimateOf(result, "psf.gaussian.sigma").value, kSigma, 0.02);
  }
  EXPECT_GE(inside, 9) << "P(X <= 8) of a binomial (12, .95) is 2e-3";
}

// Places that are off by 0.3 mm: taken for exact they bias the spread, with a prior they do not.
TEST(FootprintImages, PlacesWithAnErrorAreFitted) {
  const Sensor truth = baseSensor();
  constexpr int kBenches = 4;
  int inside = 0;
  double exact = 0, with_error = 0;
  for (int run = 0; run < kBenches; ++run) {
    PointImages points = footprints(truth, {.position_error = 0.3e-3, .seed = static_cast<std::uint64_t>(run + 1)});
    const Characterization result = fittedTo(truth, points);
    inside += holds(result, "psf.gaussian.sigma", kSigma);
    with_error += std::abs(estimateOf(result, "psf.gaussian.sigma").value - kSigma) / kBenches;
    points.position_error = 0;
    exact += std::abs(estimateOf(fittedTo(truth, points), "psf.gaussian.sigma").value - kSigma) / kBenches;
  }
  EXPECT_GE(inside, 3) << "P(X <= 2) of a binomial (4, .95) is .014";
  EXPECT_LT(with_error, 0.01);
  EXPECT_GT(exact, 2 * with_error);
}

TEST(FootprintImages, FindAKernelThatIsNotGaussian) {
  const Psf psf{.size = 3, .kernel = {0.03, 0.10, 0.03, 0.05, 0.51, 0.12, 0.03, 0.10, 0.03}};
  Sensor truth = baseSensor();
  truth.psf = psf;
  truth.readout.trigger = 0.005;
  const Characterization result = fittedTo(truth, footprints(truth, {.images = 30, .seed = 3}));
  ASSERT_EQ(result.sensor.psf.size, 3);
  for (std::size_t k = 0; k < psf.kernel.size(); ++k) EXPECT_NEAR(result.sensor.psf.kernel[k], psf.kernel[k], 0.01) << k;
}

// A stamp that is turned, as an indenter and as a mask.
TEST(FootprintImages, AnIndenterAndItsMaskAgree) {
  const Sensor truth = baseSensor();
  PointImages points = footprints(truth, {.seed = 4});
  points.mask = FootprintMask{.num_rows = 30, .num_cols = 20, .pixel = kPixel, .pressure = std::vector<float>(30 * 20, 1)};
  points.images.counts.clear();
  for (std::size_t n = 0; n < points.position.size(); ++n) {
    const Place place{points.position[n][0], points.position[n][1], points.yaw[n]};
    for (const std::uint32_t counts : reference::readOut(truth, reference::spread(truth, forcesUnder(truth, *points.mask, place, 4)))) {
      points.images.counts.push_back(static_cast<float>(counts));
    }
  }
  const double with_mask = estimateOf(fittedTo(truth, points), "psf.gaussian.sigma").value;
  points.mask.reset();
  points.indenter = {.shape = Indenter::Shape::kStamp, .size = {6e-3, 4e-3}};
  const double with_indenter = estimateOf(fittedTo(truth, points), "psf.gaussian.sigma").value;
  // Turned pixels of 0.2 mm, and rounding of counts.
  EXPECT_NEAR(with_mask, kSigma, 0.01);
  EXPECT_NEAR(with_indenter, with_mask, 0.01);
}

}  // namespace
}  // namespace taxelsim::testing
