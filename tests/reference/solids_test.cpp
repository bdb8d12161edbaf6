// Line intersections with the analytic solids against their implicit functions, evaluated densely along random lines.
#include "reference/solids.h"

#include "base/vector3.h"
#include "support/cases.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::firstHit;
using support::Random;

// Implicit function, m: negative inside, 0 on the surface; distance to the surface up to a factor.
double levelOf(const Sphere& s, const Vector3& p) {
  return length(p) - s.radius;
}
double levelOf(const Cylinder& c, const Vector3& p) {
  return std::max(std::hypot(p[0], p[1]) - c.radius, std::abs(p[2]) - c.length / 2);
}
double levelOf(const Capsule& c, const Vector3& p) {
  return length({p[0], p[1], std::max(0.0, std::abs(p[2]) - c.length / 2)}) - c.radius;
}
double levelOf(const Box& b, const Vector3& p) {
  return std::max({std::abs(p[0]) - b.size[0] / 2, std::abs(p[1]) - b.size[1] / 2, std::abs(p[2]) - b.size[2] / 2});
}
double levelOf(const HalfSpace&, const Vector3& p) {
  return -p[2];
}
double levelOf(const Cone& c, const Vector3& p) {
  return std::max(std::hypot(p[0], p[1]) - c.radius / c.height * p[2], p[2] - c.height);
}
double levelOf(const Torus& t, const Vector3& p) {
  return std::hypot(std::hypot(p[0], p[1]) - t.major_radius, p[2]) - t.minor_radius;
}
double levelOf(const Mesh&, const Vector3&) {
  return 0;
}
double firstHit(const Mesh&, const Vector3&, const Vector3&) {
  return 0;
}

// Lines start within 0.1 m of the origin and are followed over +-kReach (m).
constexpr double kReach = 0.3;
constexpr int kNumSteps = 3000;
// m. A quartic in double has a residual of about 1e-16 of the fourth power of the size at a root. Near tangency the error of t is its
// square root, but the implicit function is quadratic in t there.
constexpr double kOnSurface = 1e-11;

class SolidSeeds : public ::testing::TestWithParam<int> {};

TEST_P(SolidSeeds, FirstHitIsTheFirstSurfacePoint) {
  Random random(GetParam());
  const Object object = support::randomSolid(random, 0.03);
  int num_hits = 0;
  for (int n = 0; n < 40; ++n) {
    Vector3 origin{random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02)};
    Vector3 direction = rotate(random.rotation(), {0, 0, 1});
    if (random.chance(0.3)) {
      direction = {0, 0, 1};  // along the axis: the quadratics degenerate
    } else if (random.chance(0.2)) {
      direction = {1, 0, 0};
    }
    std::visit(
        [&](const auto& shape) {
          const double t = firstHit(shape, origin, direction);
          const auto level = [&](double s) { return levelOf(shape, add(origin, scale(s, direction))); };
          if (std::isfinite(t)) {
            ++num_hits;
            EXPECT_NEAR(level(t), 0, kOnSurface) << object.name;
          }
          for (int step = 0; step <= kNumSteps; ++step) {
            const double at = -kReach + 2 * kReach * step / kNumSteps;
            if (at < t) {
              EXPECT_GT(level(at), -kOnSurface) << object.name << ": inside before the first hit";
            }
          }
          if (t == -std::numeric_limits<double>::infinity()) {
            EXPECT_LT(level(-1e6), 0);
          }
        },
        object.shape);
  }
  EXPECT_GT(num_hits, 0) << object.name;
}

INSTANTIATE_TEST_SUITE_P(Random, SolidSeeds, support::seeds(60, 60));

// The same box as a solid and as a mesh, at random poses. The two share no intersection code.
TEST(Solids, BoxMatchesItsMesh) {
  // m: vertices are float32, 2^-25 of 10 mm. Samples near a silhouette may differ and are counted.
  constexpr double kVertexRounding = 2e-9;
  Random random(7);
  const Sensor sensor = support::gridSensor({});
  std::size_t num_samples = 0, num_covered = 0, num_beside = 0;
  for (int n = 0; n < 50; ++n) {
    const Vector3 size{0.5 * random.integer(5, 40) / 1024, 0.5 * random.integer(5, 40) / 1024, 0.5 * random.integer(5, 40) / 1024};
    const Object solid(Box{size}), mesh("box", support::boxMesh(size));
    const Pose X_SO{{random.uniform(-5e-3, 5e-3), random.uniform(-5e-3, 5e-3), 0}, random.rotation()};
    const reference::PlacedObject a{&solid, X_SO}, b{&mesh, X_SO};
    const auto heights_a = reference::surfaceHeights(sensor, {&a, 1}), heights_b = reference::surfaceHeights(sensor, {&b, 1});
    for (std::size_t k = 0; k < heights_a.size(); ++k) {
      ++num_samples;
      num_covered += std::isfinite(heights_a[k]);
      num_beside += !(heights_a[k] == heights_b[k] || std::abs(heights_a[k] - heights_b[k]) < kVertexRounding);
    }
  }
  EXPECT_GT(num_covered, num_samples / 100);
  EXPECT_EQ(num_beside, 0u) << "of " << num_samples;
}

TEST(Solids, HalfSpaceOpenDownwardsIsHitAtMinusInfinity) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(reference::firstHit(HalfSpace{}, {0, 0, 5}, {0, 0, -1}), -infinity);
  EXPECT_EQ(reference::firstHit(HalfSpace{}, {0, 0, 5}, {1, 0, 0}), -infinity);
  EXPECT_EQ(reference::firstHit(HalfSpace{}, {0, 0, -5}, {1, 0, 0}), infinity);
  EXPECT_EQ(reference::firstHit(HalfSpace{}, {0, 0, -5}, {0, 0, 2}), 2.5);
}

}  // namespace
}  // namespace taxelsim
