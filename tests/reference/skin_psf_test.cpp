// The spread by distance along the skin: against the formula written out, sums kept, and a grid's own kernel where both weigh alike.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "reference/psf.h"
#include "support/curved_sensor.h"

namespace taxelsim::reference {
namespace {

using support::Random;

constexpr double kRounding = 1e-13;  // relative: sums of up to 100 terms

std::vector<double> randomForces(Random& random, const Sensor& sensor) {
  std::vector<double> forces;
  for (int t = 0; t < numTaxels(sensor); ++t) forces.push_back(random.uniform(0, 2));
  return forces;
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(SkinPsf, OnASphereIsTheGaussianOfTheGreatCircle) {
  constexpr double kRadius = 8e-3;
  Random random(1);
  Sensor sensor = support::sphereFingertip(kRadius, 2, 1.3);
  sensor.psf = {.normalization = Psf::Normalization::kNone, .sigma = 2e-3, .reach = 5e-3};
  const std::vector<double> forces = randomForces(random, sensor), image = spread(sensor, forces);
  const std::vector<Vector3> normals = taxelNormals(sensor);
  for (std::size_t t = 0; t < image.size(); ++t) {
    double expected = 0;
    for (std::size_t source = 0; source < image.size(); ++source) {
      double cosine = 0;
      for (int axis = 0; axis < 3; ++axis) cosine += normals[t][axis] * normals[source][axis];
      const double s = kRadius * std::acos(std::min(cosine, 1.0));
      expected += s <= 5e-3 ? forces[source] * std::exp(-s * s / (2 * 2e-3 * 2e-3)) : 0;
    }
    // acos near 1 is known to the root of a double's last place: s to 1e-10 m, and the weight to s ds / sigma^2.
    EXPECT_NEAR(image[t], expected, 1e-6) << t;
  }
}

TEST(SkinPsf, KeepsTheSumOfForcesAtBordersToo) {
  for (int seed = 0; seed < 20; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    Sensor sensor = support::randomTaxels(random, random.integer(1, 80));
    sensor.psf = {.sigma = random.uniform(0.1e-3, 5e-3)};
    const std::vector<double> forces = randomForces(random, sensor);
    EXPECT_NEAR(sum(spread(sensor, forces)), sum(forces), kRounding * sum(forces));
  }
}

TEST(SkinPsf, OnAGridIsItsKernelWhereWeightsAgree) {
  Random random(2);
  Sensor by_kernel = support::gridSensor({.num_rows = 6, .num_cols = 9, .pitch_x = 2e-3, .pitch_y = 2e-3});
  for (const auto normalization : {Psf::Normalization::kPerSource, Psf::Normalization::kNone}) {
    // 9 x 9 taxels of a Gaussian of 0.7 taxels, of which 4 taxels away, e^-16, nothing is left but rounding.
    by_kernel.psf = gaussianPsf(0.7, 9, normalization);
    for (double& weight : by_kernel.psf.kernel) weight *= 2 * std::acos(-1.0) * 0.7 * 0.7;  // 1 in the middle
    Sensor by_distance = by_kernel;
    by_distance.psf = {.normalization = normalization, .sigma = 0.7 * 2e-3, .reach = 4.1 * 2e-3};
    const std::vector<double> forces = randomForces(random, by_kernel);
    const std::vector<double> one = spread(by_kernel, forces), other = spread(by_distance, forces);
    // The kernel's corners lie beyond the reach: e^(-17 / 0.98) and less, at 32 places or fewer, of forces up to 2 N.
    constexpr double kCorners = 64 * 3e-8;
    for (std::size_t t = 0; t < one.size(); ++t) EXPECT_NEAR(one[t], other[t], kCorners);
  }
}

TEST(SkinPsf, CrossesBordersOfPatches) {
  Random random(3);
  Sensor whole = support::gridSensor({.num_rows = 4, .num_cols = 5, .pitch_x = 2e-3, .pitch_y = 3e-3});
  whole.psf = {.sigma = 2e-3};
  Sensor halves = whole;
  halves.patches[0].num_rows = 2;
  halves.patches.push_back(halves.patches[0]);
  halves.patches[0].X_SP.position[0] = -2e-3;
  halves.patches[1].X_SP.position[0] = 2e-3;
  const std::vector<double> forces = randomForces(random, whole);
  const std::vector<double> one = spread(whole, forces), other = spread(halves, forces);
  for (std::size_t t = 0; t < one.size(); ++t) EXPECT_NEAR(one[t], other[t], kRounding);
}

}  // namespace
}  // namespace taxelsim::reference
