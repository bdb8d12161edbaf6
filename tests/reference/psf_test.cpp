// Sums and taps of the point spread function; numbers from an independent program.
#include "reference/psf.h"

#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::gridSensor;
using support::Random;

constexpr double kTenDigits = 1e-10;  // absolute, of the quoted numbers
constexpr double kFourDigits = 5e-5;
constexpr double kSixDigits = 5e-7;
constexpr double kRounding = 1e-14;

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

std::vector<double> spreadOfOne(Sensor sensor, const Psf& psf, int i, int j) {
  sensor.psf = psf;
  std::vector<double> force(numTaxels(sensor), 0);
  force[i * sensor.patches[0].num_cols + j] = 1;
  return reference::spread(sensor, force);
}

TEST(PaperKernel, SumAndTaps) {
  const Psf psf = gaussianPsf(0.5, 3, Psf::Normalization::kNone);
  const Sensor sensor = gridSensor({.num_rows = 5, .num_cols = 5});
  const std::vector<double> image = spreadOfOne(sensor, psf, 2, 2);
  EXPECT_NEAR(sum(image), 1.0278886326, kTenDigits);
  EXPECT_NEAR(image[12], 0.6366197724, kTenDigits);
  EXPECT_NEAR(image[11], 0.0861571172, kTenDigits);
  EXPECT_NEAR(image[6], 0.0116600979, kTenDigits);
}

TEST(PaperKernel, LosesForceAtBorders) {
  const Psf psf = gaussianPsf(0.5, 3, Psf::Normalization::kNone);
  const Sensor sensor = gridSensor({.num_rows = 5, .num_cols = 5});
  EXPECT_NEAR(sum(spreadOfOne(sensor, psf, 0, 2)), 0.9184, kFourDigits);
  EXPECT_NEAR(sum(spreadOfOne(sensor, psf, 0, 0)), 0.8206, kFourDigits);
}

TEST(PaperKernel, SumForOtherSigmas) {
  const Sensor sensor = gridSensor({.num_rows = 3, .num_cols = 3});
  const std::vector<std::pair<double, double>> sums{{.3, 1.795840}, {.4, 1.177219}, {.6, 0.993001}, {.7, 0.961907},
                                                    {.8, 0.912599}, {.9, 0.849116}, {1.0, 0.779484}};
  for (const auto& [sigma, expected] : sums) {
    EXPECT_NEAR(sum(spreadOfOne(sensor, gaussianPsf(sigma, 3, Psf::Normalization::kNone), 1, 1)), expected, kSixDigits);
  }
}

TEST(NormalizedKernel, TapsAndBorders) {
  const Sensor sensor = gridSensor({.num_rows = 5, .num_cols = 5});
  const Psf psf = gaussianPsf(0.5, 3);
  const std::vector<double> image = spreadOfOne(sensor, psf, 2, 2);
  EXPECT_NEAR(image[12], 0.6193470306, kTenDigits);
  EXPECT_NEAR(image[11], 0.0838195058, kTenDigits);
  EXPECT_NEAR(image[6], 0.0113437366, kTenDigits);
  EXPECT_NEAR(image[10] + image[11] + image[12] + image[13] + image[14], 0.7869860422,
              kTenDigits);  // centre tap of the one-dimensional kernel

  // Per-source normalization restores the force that zero padding would lose at the border.
  EXPECT_NEAR(spreadOfOne(sensor, psf, 0, 2)[2], 0.6193470306 / 0.893493, 1e-6);
  EXPECT_NEAR(spreadOfOne(sensor, psf, 0, 0)[0], 0.6193470306 / 0.798330, 1e-6);
  for (const auto& [i, j] : {std::pair{0, 0}, {0, 2}, {4, 1}, {2, 2}}) {
    EXPECT_NEAR(sum(spreadOfOne(sensor, psf, i, j)), 1, kRounding);
  }
}

TEST(AnyKernel, PerSourceNormalizationConservesForce) {
  for (int seed = 0; seed < 100; ++seed) {
    Random random(seed);
    Sensor sensor = support::randomSensor(random, {.max_patches = 3});
    sensor.psf.normalization = Psf::Normalization::kPerSource;
    std::vector<double> force;
    for (int t = 0; t < numTaxels(sensor); ++t) {
      force.push_back(random.uniform(0, 3));
    }
    EXPECT_NEAR(sum(reference::spread(sensor, force)) / sum(force), 1, 100 * kRounding);
  }
}

TEST(AnyKernel, EntryMovesForceByItsOffset) {
  Psf psf;
  psf.size = 5;
  psf.kernel.assign(25, 0);
  psf.kernel[(2 + 1) * 5 + (2 - 2)] = 1;  // g(1, -2): spread(i, j) = F(i - 1, j + 2)
  const std::vector<double> image = spreadOfOne(gridSensor({.num_rows = 5, .num_cols = 6}), psf, 2, 3);
  EXPECT_DOUBLE_EQ(image[3 * 6 + 1], 1);
  EXPECT_DOUBLE_EQ(sum(image), 1);
}

TEST(AnyKernel, DoesNotCrossPatches) {
  Sensor sensor = gridSensor({.num_rows = 2, .num_cols = 2});
  sensor.patches.push_back(sensor.patches[0]);
  sensor.psf = gaussianPsf(1, 9);
  const std::vector<double> image = reference::spread(sensor, std::vector<double>{1, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_NEAR(image[0] + image[1] + image[2] + image[3], 1, kRounding);
  EXPECT_EQ(image[4] + image[5] + image[6] + image[7], 0);
}

}  // namespace
}  // namespace taxelsim
