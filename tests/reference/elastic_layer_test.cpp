// Elastic layer of the reference against contact mechanics: influence coefficients, Sneddon's sphere and punch, Hertzian line contact, and
// layers bonded to a rigid base.
#include "reference/elastic_layer.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::Layer;
using reference::LayerSolution;
using support::Random;

constexpr double kPi = std::numbers::pi;
constexpr double kNoSurface = -std::numeric_limits<double>::infinity();
constexpr double kModulus = 1e6;  // Pa

double planeModulus(double poisson_ratio) {
  return kModulus / (1 - poisson_ratio * poisson_ratio);
}

// num x num nodes with the given spacing (m).
Layer squareLayer(int num, double spacing, double poisson_ratio, ElasticLayer::Base base, double thickness) {
  Layer layer{{.num_rows = num, .num_cols = num, .spacing = {spacing, spacing}}, {}};
  layer.influence =
      layerInfluence({.elastic_modulus = kModulus, .poisson_ratio = poisson_ratio, .base = base}, thickness, layer.nodes.spacing, num, num);
  return layer;
}

Layer halfSpace(int num, double spacing, double poisson_ratio = 0.49) {
  return squareLayer(num, spacing, poisson_ratio, ElasticLayer::Base::kHalfSpace, 1);
}

// Overlap with the surface height(x, y), origin in the middle of the nodes, m.
template <typename Height>
std::vector<double> overlapWith(const Layer& layer, Height&& height) {
  std::vector<double> overlap;
  for (int u = 0; u < layer.nodes.num_rows; ++u) {
    for (int v = 0; v < layer.nodes.num_cols; ++v) {
      overlap.push_back(-height((u - (layer.nodes.num_rows - 1) / 2.0) * layer.nodes.spacing[0],
                                (v - (layer.nodes.num_cols - 1) / 2.0) * layer.nodes.spacing[1]));
    }
  }
  return overlap;
}

double peakOf(const LayerSolution& solution) {
  return *std::max_element(solution.pressure.begin(), solution.pressure.end());
}

// Influence coefficients.

// A. E. H. Love (1929), unit square; digits from an independent quadrature.
TEST(LayerInfluence, UnitSquareOnHalfSpaceMatchesLove) {
  const std::vector<double> influence =
      layerInfluence({.elastic_modulus = 1, .poisson_ratio = 0, .base = ElasticLayer::Base::kHalfSpace}, 1, {1, 1}, 3, 3);
  EXPECT_NEAR(influence[0], 4 * std::asinh(1.0) / kPi, 1e-14);
  EXPECT_NEAR(influence[0], 1.12219970, 5e-9);
  EXPECT_NEAR(influence[3], 0.33042149, 5e-9);
  EXPECT_NEAR(influence[1], 0.33042149, 5e-9);
  EXPECT_NEAR(influence[4], 0.23067836, 5e-9);
  EXPECT_NEAR(influence[6], 0.16077577, 5e-9);
}

// Far away a cell acts as a point load, 1 / (pi E* r), with a relative error of its second moment over r^2.
TEST(LayerInfluence, FarFieldMatchesBoussinesq) {
  const std::vector<double> influence =
      layerInfluence({.elastic_modulus = 2, .poisson_ratio = 0.3, .base = ElasticLayer::Base::kHalfSpace}, 1, {0.5, 2}, 100, 100);
  const double r = std::hypot(99 * 0.5, 99 * 2);
  EXPECT_NEAR(influence.back() * kPi * 2 / (1 - 0.09) * r, 1, 2 * 2 * 2 / (r * r));
}

// Thick limit: half-space. Thin limit: h / M, or (2/3) x^3 for an incompressible layer.
TEST(LayerInfluence, KernelHasThickAndThinLimits) {
  for (const double nu : {0.0, 0.3, 0.45, 0.49, 0.5}) {
    EXPECT_NEAR(layerKernel(30, nu), 1, 1e-12);
    EXPECT_NEAR(layerKernel(1000, nu), 1, 1e-12);
    // The asymptotic formula is used above x = 20.
    EXPECT_NEAR(layerKernel(std::nextafter(20.0, 21.0), nu), layerKernel(20, nu), 1e-13);
    constexpr double kSmall = 1e-4;
    const double expected = nu == 0.5 ? 2.0 / 3 * kSmall * kSmall * kSmall : kSmall * (1 - 2 * nu) / (2 * (1 - nu) * (1 - nu));
    EXPECT_NEAR(layerKernel(kSmall, nu) / expected, 1, 1e-4) << nu;
    for (double x = 0.01; x < 20; x *= 1.1) EXPECT_GT(layerKernel(x, nu), 0);
  }
}

// Under a uniform load the displacement is p h / M, M the confined modulus: the sum of all coefficients.
TEST(LayerInfluence, SumIsThicknessOverConfinedModulus) {
  for (const double nu : {0.0, 0.3, 0.45}) {
    for (const double spacing : {0.1, 0.5, 3.0, 8.0}) {
      const auto num = static_cast<int>(30 / spacing) + 2;
      const Layer layer = squareLayer(num, spacing, nu, ElasticLayer::Base::kBonded, 1);
      double sum = 0;
      for (int u = 1 - num; u < num; ++u) {
        for (int v = 1 - num; v < num; ++v) sum += layer.influence[static_cast<std::size_t>(std::abs(u) * num + std::abs(v))];
      }
      const double confined = kModulus * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
      // Tolerance: truncation of the layer's influence at 25 thicknesses, and quadrature of the correction.
      EXPECT_NEAR(sum * confined, 1, 2e-4) << nu << " " << spacing;
    }
  }
}

// A layer much thicker than a cell acts as a half-space near the load.
TEST(LayerInfluence, ThickLayerMatchesHalfSpace) {
  constexpr double kThick = 1e5;
  const Layer thick = squareLayer(8, 1, 0.3, ElasticLayer::Base::kBonded, kThick), deep = halfSpace(8, 1, 0.3);
  for (std::size_t n = 0; n < deep.influence.size(); ++n) EXPECT_NEAR(thick.influence[n] / deep.influence[n], 1, 20 / kThick);
}

// Contact solution.

// Complementarity conditions, checked with an independent matrix product.
TEST(LayerSolution, SatisfiesContactConditions) {
  Random random(3);
  for (int n = 0; n < 10; ++n) {
    const auto base = n % 2 == 0 ? ElasticLayer::Base::kHalfSpace : ElasticLayer::Base::kBonded;
    const Layer layer = squareLayer(14, 1, n % 3 == 0 ? 0.5 : 0.3, base, random.uniform(0.5, 4));
    // A rough surface with holes.
    std::vector<double> overlap = overlapWith(layer, [&](double x, double y) { return (x * x + y * y) / 30 - random.uniform(0.5, 1); });
    for (double& d : overlap) d = random.chance(0.1) ? kNoSurface : d;
    const LayerSolution solution = solveLayer(layer, overlap);
    for (int m = 0; m < 14 * 14; ++m) {
      double w = 0;
      for (int k = 0; k < 14 * 14; ++k) {
        w += layer.influence[static_cast<std::size_t>(std::abs(m / 14 - k / 14) * 14 + std::abs(m % 14 - k % 14))] *
             solution.pressure[static_cast<std::size_t>(k)];
      }
      const double d = overlap[static_cast<std::size_t>(m)], p = solution.pressure[static_cast<std::size_t>(m)];
      EXPECT_GE(p, 0);
      EXPECT_GE(w, d - 1e-9);
      if (p > 0) {
        EXPECT_NEAR(w, d, 1e-9);
      }
    }
  }
}

TEST(LayerSolution, NoOverlapGivesNoForce) {
  const Layer layer = halfSpace(5, 1);
  for (const double d : {kNoSurface, -1.0, 0.0}) EXPECT_EQ(totalForce(layer, solveLayer(layer, std::vector<double>(25, d)).pressure), 0);
}

// Half-space.

// I. N. Sneddon (1965), rigid sphere: delta = (a/2) ln((R+a)/(R-a)), F = (E*/2) [(a^2+R^2) ln((R+a)/(R-a)) - 2 a R]. Hertz's peak p0 = 2 E*
// a / (pi R) holds within O(a^2/R^2), 1 % at a/R = 0.2.
TEST(HalfSpace, SphereMatchesSneddon) {
  constexpr double kForceError = 0.02, kPeakError = 0.03;
  Random random(1);
  for (const double a : {0.05, 0.1, 0.2}) {
    const double logarithm = std::log((1 + a) / (1 - a));
    const double depth = a / 2 * logarithm, force = planeModulus(0.49) / 2 * ((a * a + 1) * logarithm - 2 * a);
    const Layer layer = halfSpace(14, a / 4);
    for (int n = 0; n < 20; ++n) {
      const double x0 = random.uniform(-0.5, 0.5) * a / 4, y0 = random.uniform(-0.5, 0.5) * a / 4;
      const LayerSolution solution = solveLayer(layer, overlapWith(layer, [&](double x, double y) {
                                                  return 1 - depth - std::sqrt(1 - (x - x0) * (x - x0) - (y - y0) * (y - y0));
                                                }));
      EXPECT_NEAR(totalForce(layer, solution.pressure) / force, 1, kForceError) << a;
      EXPECT_NEAR(peakOf(solution) / (2 * planeModulus(0.49) * a / kPi), 1, kPeakError) << a;
    }
  }
}

// Hertzian line contact in the middle section of a long cylinder, whose depth is undefined in plane strain. With P' the load per length
// there: p0^2 = E* P' / (pi R), a^2 = 4 P' R / (pi E*).
TEST(HalfSpace, MiddleSectionOfCylinderMatchesHertz) {
  // Discretisation with a quarter of the half-width; the ends are twelve half-widths away.
  constexpr double kPeakError = 0.02;
  constexpr double kDepth = 0.02;
  constexpr int kRows = 24, kCols = 96;
  const double spacing = 0.025;  // about a quarter of the half-width
  Layer layer{{.num_rows = kRows, .num_cols = kCols, .spacing = {spacing, spacing}}, {}};
  layer.influence = layerInfluence({.elastic_modulus = kModulus, .poisson_ratio = 0.3, .base = ElasticLayer::Base::kHalfSpace}, 1,
                                   layer.nodes.spacing, kRows, kCols);
  const LayerSolution solution = solveLayer(layer, overlapWith(layer, [](double x, double) { return 1 - kDepth - std::sqrt(1 - x * x); }));
  double per_length = 0, peak = 0;
  for (int u = 0; u < kRows; ++u) {
    const double p = solution.pressure[static_cast<std::size_t>(u * kCols + kCols / 2)];
    per_length += p * spacing;
    peak = std::max(peak, p);
  }
  const double half_width = std::sqrt(4 * per_length / (kPi * planeModulus(0.3)));
  EXPECT_GT(half_width, 3.5 * spacing);
  EXPECT_NEAR(peak / std::sqrt(planeModulus(0.3) * per_length / kPi), 1, kPeakError);
}

// Flat punch of radius a: F = 2 a E* delta, p = F / (2 pi a^2) / sqrt(1 - r^2/a^2). The discrete rim is a staircase, where p is singular.
TEST(HalfSpace, FlatPunchMatchesClosedForm) {
  constexpr double kForceError = 0.025, kPressureError = 0.08, kInside = 0.7;
  constexpr double kDepth = 1e-3;
  Random random(2);
  const double spacing = 1.0 / 8;
  const Layer layer = halfSpace(20, spacing);
  for (int n = 0; n < 20; ++n) {
    const double x0 = random.uniform(-0.5, 0.5) * spacing, y0 = random.uniform(-0.5, 0.5) * spacing;
    const auto radius = [&](double x, double y) { return std::hypot(x - x0, y - y0); };
    const LayerSolution solution =
        solveLayer(layer, overlapWith(layer, [&](double x, double y) { return radius(x, y) <= 1 ? -kDepth : -kNoSurface; }));
    const std::vector<double> r = overlapWith(layer, [&](double x, double y) { return -radius(x, y); });
    // Compare with the disc of the same area.
    const auto num_covered = static_cast<double>(std::count_if(r.begin(), r.end(), [](double radius_at) { return radius_at <= 1; }));
    const double force = 2 * std::sqrt(num_covered * layer.nodes.area() / kPi) * planeModulus(0.49) * kDepth;
    EXPECT_NEAR(totalForce(layer, solution.pressure) / force, 1, kForceError);
    for (std::size_t m = 0; m < r.size(); ++m) {
      if (r[m] > kInside) continue;
      EXPECT_NEAR(solution.pressure[m] / (force / (2 * kPi) / std::sqrt(1 - r[m] * r[m])), 1, kPressureError) << r[m];
    }
  }
}

// Bonded layer.

// Parabolic sphere of radius R on a layer of thickness h, contact radius a / h: force relative to Hertz at the same depth, and relative to
// a Winkler foundation of stiffness M / h, M the confined modulus. From an independent solution of the Fredholm equation with 80 Gauss
// points. For nu = 0.5, where M is infinite, the third number is chi = sqrt(R delta) / h; otherwise chi follows from the two ratios, to 0.2
// %.
struct SphereOnLayer {
  double poisson_ratio, contact_radius, force, springs_or_chi;

  double chi() const {
    if (poisson_ratio == 0.5) return springs_or_chi;
    const double nu = poisson_ratio, confined = kModulus * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
    return force / springs_or_chi * 4 * planeModulus(nu) / (3 * kPi * confined);
  }
};

void PrintTo(const SphereOnLayer& c, std::ostream* out) {
  *out << "Poisson's ratio " << c.poisson_ratio << ", contact radius " << c.contact_radius;
}

class BondedSphere : public ::testing::TestWithParam<SphereOnLayer> {};

TEST_P(BondedSphere, ForceMatchesFredholmSolution) {
  const SphereOnLayer& row = GetParam();
  constexpr double kForceError = 0.02;
  constexpr double kRadius = 1000;  // thicknesses
  const double depth = row.chi() * row.chi() / kRadius;
  // Ten nodes per contact radius, centre between nodes, half a radius of margin.
  const double spacing = row.contact_radius / 10;
  const Layer layer = squareLayer(30, spacing, row.poisson_ratio, ElasticLayer::Base::kBonded, 1);
  const LayerSolution solution = solveLayer(layer, overlapWith(layer, [&](double x, double y) {
                                              const double dx = x - 0.2 * spacing, dy = y + 0.3 * spacing;
                                              return (dx * dx + dy * dy) / (2 * kRadius) - depth;
                                            }));
  const double hertz = 4.0 / 3 * planeModulus(row.poisson_ratio) * std::sqrt(kRadius) * std::pow(depth, 1.5);
  EXPECT_NEAR(totalForce(layer, solution.pressure) / hertz / row.force, 1, kForceError);
}

INSTANTIATE_TEST_SUITE_P(Table, BondedSphere,
                         ::testing::Values(SphereOnLayer{0.5, 0.1, 1.12354, 0.0962}, SphereOnLayer{0.5, 0.2, 1.26977, 0.1851},
                                           SphereOnLayer{0.5, 0.5, 1.85712, 0.4172}, SphereOnLayer{0.5, 1, 3.37110, 0.7479},
                                           SphereOnLayer{0.5, 2, 8.46801, 1.3489}, SphereOnLayer{0.5, 3, 16.7618, 1.9150},
                                           SphereOnLayer{0.5, 5, 46.2162, 2.9964}, SphereOnLayer{0.5, 8, 135.613, 4.5616},
                                           SphereOnLayer{0.49, 0.5, 1.832, 0.143}, SphereOnLayer{0.49, 1, 3.265, 0.141},
                                           SphereOnLayer{0.49, 2, 7.843, 0.187}, SphereOnLayer{0.49, 3, 14.700, 0.245},
                                           SphereOnLayer{0.49, 5, 35.448, 0.369}, SphereOnLayer{0.49, 8, 81.809, 0.541},
                                           SphereOnLayer{0.45, 0.1, 1.1125, 1.617}, SphereOnLayer{0.45, 0.5, 1.7505, 0.579},
                                           SphereOnLayer{0.45, 2, 6.2509, 0.614}, SphereOnLayer{0.45, 5, 19.745, 0.813},
                                           SphereOnLayer{0.45, 8, 35.004, 0.902}, SphereOnLayer{0.3, 0.1, 1.0940, 3.905},
                                           SphereOnLayer{0.3, 0.5, 1.5909, 1.266}, SphereOnLayer{0.3, 1, 2.4156, 1.040},
                                           SphereOnLayer{0.3, 3, 6.3405, 0.990}, SphereOnLayer{0.3, 8, 16.541, 0.997}));

// Flat punch of radius a / h on the same layer: F / (2 E* a delta).
struct PunchOnLayer {
  double poisson_ratio, contact_radius, force;
};

void PrintTo(const PunchOnLayer& c, std::ostream* out) {
  *out << "Poisson's ratio " << c.poisson_ratio << ", contact radius " << c.contact_radius;
}

class BondedPunch : public ::testing::TestWithParam<PunchOnLayer> {};

TEST_P(BondedPunch, ForceMatchesFredholmSolution) {
  const auto [nu, a, expected] = GetParam();
  constexpr double kForceError = 0.02;
  constexpr double kDepth = 1e-3;
  constexpr double kCells = 20;  // per punch radius
  const auto disc = [](double x, double y) { return std::hypot(x, y) <= kCells ? -kDepth : -kNoSurface; };
  // Scale the spacing so that the disc of the same area has radius a.
  const std::vector<double> covered = overlapWith(squareLayer(41, 1, nu, ElasticLayer::Base::kHalfSpace, 1), disc);
  const auto num_covered = static_cast<double>(std::count(covered.begin(), covered.end(), kDepth));
  const Layer layer = squareLayer(41, a / std::sqrt(num_covered / kPi), nu, ElasticLayer::Base::kBonded, 1);
  EXPECT_NEAR(totalForce(layer, solveLayer(layer, covered).pressure) / (2 * planeModulus(nu) * a * kDepth) / expected, 1, kForceError);
}

INSTANTIATE_TEST_SUITE_P(Table, BondedPunch,
                         ::testing::Values(PunchOnLayer{0.5, 0.1, 1.1260}, PunchOnLayer{0.5, 1, 3.6187}, PunchOnLayer{0.5, 2, 9.1495},
                                           PunchOnLayer{0.5, 5, 50.140}, PunchOnLayer{0.49, 0.5, 1.9028}, PunchOnLayer{0.49, 2, 8.3370},
                                           PunchOnLayer{0.49, 5, 36.263}, PunchOnLayer{0.45, 0.2, 1.2523}, PunchOnLayer{0.45, 1, 3.0914},
                                           PunchOnLayer{0.45, 5, 19.156}, PunchOnLayer{0.3, 0.1, 1.0954}, PunchOnLayer{0.3, 1, 2.4835},
                                           PunchOnLayer{0.3, 3, 6.2613}, PunchOnLayer{0.3, 5, 10.100}));

}  // namespace
}  // namespace taxelsim
