// Reference depth of random meshes against ray casting with Embree, an independent implementation in float32.
#include "support/cases.h"
#include "support/embree_oracle.h"
#include "support/envelope.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::PlacedObject;

// m, lateral: Embree rounds vertices and ray origins to float32 (half an ulp of coordinates up to 62.5 mm: 1.9e-9 m each) and intersects
// with a few rounded products (2^-24 of 62.5 mm: 3.7e-9 m each). Covers five of these.
constexpr double kShift = 2e-8;
// m, along the ray, which starts up to 0.1 m below: t is a quotient with about ten roundings of 6e-9 m.
constexpr double kMarginZ = 6e-8;
// Fraction of samples outside the envelope: slivers thinner than kShift, or vertices on a sample, may lie between its nine probes.
constexpr double kTieFraction = 1e-4;

class EmbreeSeeds : public ::testing::TestWithParam<int> {};

TEST_P(EmbreeSeeds, HeightsAgree) {
  support::Random random(GetParam());
  std::size_t num_samples = 0, num_hits = 0, num_ties = 0;
  for (int scene = 0; scene < 4; ++scene) {
    Sensor sensor = support::randomSensor(random);
    std::vector<Object> objects;
    for (int n = random.integer(1, 3); n > 0; --n) {
      objects.push_back(support::randomMeshObject(random, 0.02));
    }
    std::vector<PlacedObject> placed;
    for (const Object& object : objects) {
      placed.push_back({&object, support::randomContact(random, sensor, object)});
    }
    const std::vector<double> rays = support::embreeHeights(sensor.patches[0], sensor.samples_per_taxel, placed);
    const support::Bounded bounds = support::heightEnvelope(sensor, placed, kShift, kMarginZ);
    ASSERT_EQ(rays.size(), bounds.low.size());
    for (std::size_t n = 0; n < rays.size(); ++n) {
      ++num_samples;
      num_hits += std::isfinite(rays[n]);
      num_ties += !(rays[n] >= bounds.low[n] && rays[n] <= bounds.high[n]);
    }
  }
  EXPECT_GT(num_hits, 0u);
  EXPECT_LE(static_cast<double>(num_ties), kTieFraction * static_cast<double>(num_samples)) << "of " << num_samples << " samples";
}

INSTANTIATE_TEST_SUITE_P(Random, EmbreeSeeds, support::seeds(25, 25));

// A loose envelope would make the comparison above meaningless.
TEST(Envelope, IsTightAwayFromSilhouettes) {
  support::Random random(3);
  const Sensor sensor = support::gridSensor();
  const Object object("sphere", support::icosphere(0.01, 3, 0, random));
  const PlacedObject placed{&object, support::poseAtDepth(sensor, object, random.rotation(), 0, 0, 1e-3)};
  const support::Bounded bounds = support::heightEnvelope(sensor, {&placed, 1}, kShift, kMarginZ);
  std::size_t num_covered = 0, num_loose = 0;
  for (std::size_t n = 0; n < bounds.low.size(); ++n) {
    num_covered += std::isfinite(bounds.low[n]);
    num_loose += std::isfinite(bounds.low[n]) && !(bounds.high[n] - bounds.low[n] < 1e-6);
  }
  EXPECT_GT(num_covered, 300u);
  EXPECT_LT(num_loose, num_covered / 50);
}

}  // namespace
}  // namespace taxelsim
