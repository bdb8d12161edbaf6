// PSF by distance along the skin: against the explicit formula, conservation of force, and agreement with the kernel on a grid.
#include "base/vector3.h"
#include "reference/psf.h"
#include "support/curved_sensor.h"
#include "support/test.h"

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

TEST(SkinPsf, OnASphereIsAGaussianOfTheGreatCircleDistance) {
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
    // acos near 1 is accurate to the square root of machine epsilon: s to 1e-10 m, the weight to s ds / sigma^2.
    EXPECT_NEAR(image[t], expected, 1e-6) << t;
  }
}

TEST(SkinPsf, ConservesForce) {
  for (int seed = 0; seed < 20; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    Sensor sensor = support::randomTaxels(random, random.integer(1, 80));
    sensor.psf = {.sigma = random.uniform(0.1e-3, 5e-3)};
    const std::vector<double> forces = randomForces(random, sensor);
    EXPECT_NEAR(sum(spread(sensor, forces)), sum(forces), kRounding * sum(forces));
  }
}

TEST(SkinPsf, MatchesTheKernelOnAGrid) {
  Random random(2);
  Sensor by_kernel = support::gridSensor({.num_rows = 6, .num_cols = 9, .pitch_x = 2e-3, .pitch_y = 2e-3});
  for (const auto normalization : {Psf::Normalization::kPerSource, Psf::Normalization::kNone}) {
    // A kernel of 9 x 9 taxels with sigma = 0.7 taxels: e^-16 at 4 taxels.
    by_kernel.psf = gaussianPsf(0.7, 9, normalization);
    for (double& weight : by_kernel.psf.kernel) weight *= 2 * std::acos(-1.0) * 0.7 * 0.7;  // 1 in the middle
    Sensor by_distance = by_kernel;
    by_distance.psf = {.normalization = normalization, .sigma = 0.7 * 2e-3, .reach = 4.1 * 2e-3};
    const std::vector<double> forces = randomForces(random, by_kernel);
    const std::vector<double> one = spread(by_kernel, forces), other = spread(by_distance, forces);
    // The corners of the kernel are beyond the reach: at most e^(-17 / 0.98) in at most 32 entries, times forces up to 2 N.
    constexpr double kCorners = 64 * 3e-8;
    for (std::size_t t = 0; t < one.size(); ++t) EXPECT_NEAR(one[t], other[t], kCorners);
  }
}

std::vector<Shear> randomShear(Random& random, const Sensor& sensor) {
  std::vector<Shear> shear;
  for (int t = 0; t < numTaxels(sensor); ++t) shear.push_back({random.uniform(-1, 1), random.uniform(-1, 1)});
  return shear;
}

Sensor withRandomAxes(Random& random, Sensor sensor) {
  for (GridPatch& patch : sensor.patches) patch.X_SP.rotation = patch.X_SP.rotation * axisAngle({0, 0, 1}, random.uniform(-3, 3));
  return sensor;
}

// On a cylinder, parallel transport conserves the axial and the circumferential component separately.
TEST(SkinPsf, ShearIsConservedAlongAndAroundACylinder) {
  Random random(4);
  Sensor sensor = withRandomAxes(random, support::cylinderFingertip(8e-3, 1.4, 9, 5, 2.4e-3));
  sensor.psf = {.sigma = 2e-3};
  const std::vector<Shear> shear = randomShear(random, sensor), image = spreadShear(sensor, shear);
  const std::vector<Vector3> normals = taxelNormals(sensor);
  const auto sums = [&](const std::vector<Shear>& taxel_shear) {
    double along = 0, around = 0;
    for (std::size_t t = 0; t < taxel_shear.size(); ++t) {
      const Vector3 force = rotate(sensor.patches[t].X_SP.rotation, {taxel_shear[t][0], taxel_shear[t][1], 0});
      along += force[1];
      around += dot(force, cross({0, 1, 0}, normals[t]));
    }
    return std::array{along, around};
  };
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(sums(image)[k], sums(shear)[k], 45 * kRounding);
}

// Invariant under the choice of taxel axes; the spread shear stays within the spread friction cone.
TEST(SkinPsf, ShearIsIndependentOfTaxelAxesAndStaysInTheCone) {
  Random random(6);
  for (int kind = 0; kind < 6; ++kind) {
    const Sensor sensor = support::curvedSensor(random, kind), turned = withRandomAxes(random, sensor);
    std::vector<Shear> shear = randomShear(random, sensor), shear_turned;
    const auto inFrame = [](const Sensor& to, const Sensor& from, std::size_t t, const Shear& q) {
      const Vector3 q_P = rotate(inverse(to.patches[t].X_SP).rotation, rotate(from.patches[t].X_SP.rotation, {q[0], q[1], 0}));
      return Shear{q_P[0], q_P[1]};
    };
    for (std::size_t t = 0; t < shear.size(); ++t) shear_turned.push_back(inFrame(turned, sensor, t, shear[t]));
    const std::vector<Shear> image = spreadShear(sensor, shear), image_turned = spreadShear(turned, shear_turned);
    std::vector<double> cone;
    for (const Shear& q : shear) cone.push_back(std::hypot(q[0], q[1]));
    const std::vector<double> largest = spread(sensor, cone);
    for (std::size_t t = 0; t < shear.size(); ++t) {
      const Shear back = inFrame(sensor, turned, t, image_turned[t]);
      EXPECT_NEAR(back[0], image[t][0], 1e-12);
      EXPECT_NEAR(back[1], image[t][1], 1e-12);
      EXPECT_LE(std::hypot(image[t][0], image[t][1]), largest[t] * (1 + 1e-12));
    }
  }
}

TEST(SkinPsf, CrossesPatchBorders) {
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
