// HausdorffBound against closed forms, and against brute force on random surfaces.
#include "geometry/hausdorff_bound.h"

#include "geometry/brute_force_distance.h"
#include "geometry/is_within.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Random;

// Relative resolution of the check: a millionth of the bound (findViolation()), and twice that for the rounding of float32 vertices of 1 cm
// (6e-10 m) at bounds of 1 mm.
constexpr double kResolution = 3e-6;

void expectHausdorffDistance(const Mesh& mesh, const Mesh& surface, double distance) {
  EXPECT_TRUE(isWithin(mesh, surface, distance * (1 + kResolution)));
  EXPECT_FALSE(isWithin(mesh, surface, distance * (1 - kResolution)));
}

// A flat square of side 1 cm at height z, in num_cells x num_cells cells of two triangles.
Mesh plane(int num_cells, float z) {
  Random random(1);
  Mesh mesh = support::sheetWithHoles(num_cells, 0.01, 0, 0, random);
  for (auto& vertex : mesh.vertices) vertex[2] = z;
  return mesh;
}

Mesh scaled(Mesh mesh, float factor) {
  for (auto& vertex : mesh.vertices) {
    for (float& coordinate : vertex) coordinate *= factor;
  }
  return mesh;
}

TEST(TriangleTree, FindsTheNearestOfRandomTriangles) {
  Random random(1);
  for (const int num_triangles : {1, 3, 5, 40, 333}) {
    const Mesh soup = support::triangleSoup(num_triangles, 0.01, random);
    const TriangleTree tree(soup);
    SearchBudget budget;
    for (int n = 0; n < 200; ++n) {
      const Vector3 p{random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03)};
      const double distance = distanceToSurface(p, soup);
      const std::optional<TriangleTree::Nearest> nearest = tree.nearest(p, 1, budget);
      ASSERT_TRUE(nearest);
      // About twenty rounding errors of coordinates below 0.1 m.
      constexpr double kTolerance = 1e-15;
      EXPECT_NEAR(nearest->distance, distance, kTolerance);
      const auto& [a, b, c] = tree.corners(nearest->triangle);
      EXPECT_NEAR(distanceToTriangle(p, a, b, c), distance, kTolerance);
      EXPECT_FALSE(tree.nearest(p, distance * (1 - 1e-9), budget));
      EXPECT_TRUE(tree.nearest(p, distance * (1 + 1e-9), budget));
    }
    EXPECT_GT(budget.spent, 0u);
  }
}

TEST(TriangleTree, HandlesDegenerateTriangles) {
  const Vector3 a{0, 0, 0}, b{2, 0, 0}, c{1, 0, 0};
  EXPECT_EQ(squaredDistance({1, 1, 0}, {a, a, a}), 2);
  EXPECT_EQ(squaredDistance({1, 1, 0}, {a, b, b}), 1);
  EXPECT_EQ(squaredDistance({1, 1, 0}, {a, b, c}), 1);
  EXPECT_EQ(squaredDistance({3, 0, 0}, {c, a, b}), 1);
}

TEST(HausdorffBound, OfParallelPlanes) {
  // Triangles of one plane are smaller or larger than those of the other, and overlap several of them.
  for (const auto& [one, other] : {std::pair{1, 1}, {1, 7}, {7, 1}, {7, 10}, {2, 60}, {60, 2}}) {
    expectHausdorffDistance(plane(one, 0), plane(other, 0.001f), 0.001f);
  }
}

TEST(HausdorffBound, OfASurfaceToItselfIsZero) {
  Random random(2);
  const Mesh soup = support::triangleSoup(100, 0.01, random);
  EXPECT_TRUE(isWithin(soup, soup, 1e-12));
  EXPECT_FALSE(isWithin(soup, soup, 0));  // no bound below the rounding errors can be proven
}

TEST(HausdorffBound, OfAPlaneThatExtendsBeyondTheOther) {
  Mesh larger = plane(5, 0.001f);
  for (auto& vertex : larger.vertices) vertex[0] *= 1.5f;  // extends by 2.5 mm on both sides
  expectHausdorffDistance(larger, plane(3, 0), std::hypot(0.0025, 0.001));
  expectHausdorffDistance(plane(3, 0), larger, 0.001f);
}

// The corners of the lid lie on the roof, whose ridge is 1 mm higher. The largest distance is in the interior of the lid.
TEST(HausdorffBound, FindsViolationsInTheInterior) {
  const Mesh roof{
      {{-0.005f, -0.01f, 0}, {-0.005f, 0.01f, 0}, {0, -0.01f, 0.001f}, {0, 0.01f, 0.001f}, {0.005f, -0.01f, 0}, {0.005f, 0.01f, 0}},
      {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}}};
  const Mesh lid{{{-0.005f, -0.005f, 0}, {0.005f, -0.005f, 0}, {0.005f, 0.005f, 0}, {-0.005f, 0.005f, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  // From the middle of the lid to the slope of the roof: 1 mm x cos(atan(1 / 5)).
  expectHausdorffDistance(lid, roof, 0.001 * 5 / std::sqrt(26.0));
}

TEST(HausdorffBound, OfConcentricSpheres) {
  Random random(3);
  const Mesh inner = support::icosphere(0.01, 3, 0, random);
  const Mesh outer = scaled(inner, 1.0625f);  // exact in float32 except for the last bit
  // The nearest point to a corner of the outer sphere is the same corner of the inner one. All other points are nearer.
  expectHausdorffDistance(outer, inner, 0.0625 * 0.01);
  EXPECT_TRUE(isWithin(inner, outer, 0.0625 * 0.01));
  // Corners of the finer mesh lie on the sphere, at most one sagitta above the triangles of the coarser mesh: r - sqrt(r^2 - c^2) with
  // c the circumradius of the largest triangle. Edges of a level-2 icosphere are at most 0.325 r, and its triangles nearly regular: c
  // < 0.19 r.
  const Mesh coarse = support::icosphere(0.01, 2, 0, random), fine = support::icosphere(0.01, 4, 0, random);
  EXPECT_TRUE(isWithin(fine, coarse, 0.01 * (1 - std::sqrt(1 - 0.19 * 0.19))));
  EXPECT_FALSE(isWithin(fine, coarse, 0.01 * (1 - std::sqrt(1 - 0.15 * 0.15))));
}

TEST(HausdorffBound, OfAnEmptySurfaceIsInfinite) {
  EXPECT_FALSE(isWithin(plane(1, 0), {}, 1));
  EXPECT_TRUE(isWithin({}, plane(1, 0), 1e-9));
}

TEST(HausdorffBound, ProvesNothingOnceTheBudgetIsExhausted) {
  const Mesh mesh = plane(9, 0), surface = plane(7, 0);
  const TriangleTree tree(surface);
  SearchBudget budget{.max = 20};
  HausdorffBound check(tree, 1e-5, budget);
  std::size_t num_proven = 0;
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle)
    num_proven += !check.findViolation(cornersOf(mesh, triangle));
  EXPECT_TRUE(budget.isExhausted());
  EXPECT_LT(num_proven, 5u);
}

// Random pairs of close surfaces: a proven bound holds at every sample, and a counterexample lies on the triangle and violates the bound.
RC_GTEST_PROP(HausdorffBoundOfRandomSurfaces, AgreesWithBruteForce, (std::uint32_t seed)) {
  Random random(seed);
  const double size = std::pow(10, random.uniform(-4, 1));
  Mesh surface, mesh;
  switch (random.integer(0, 2)) {
    case 0:
      surface = support::icosphere(size, random.integer(0, 2), random.uniform(0, 0.1), random);
      mesh = support::icosphere(size, random.integer(0, 2), random.uniform(0, 0.1), random);
      break;
    case 1:
      surface = support::sheetWithHoles(random.integer(1, 9), size, size / 20, 0.2, random);
      mesh = support::sheetWithHoles(random.integer(1, 9), size, size / 20, 0, random);
      break;
    default:
      surface = support::triangleSoup(random.integer(1, 60), size, random);
      mesh = support::triangleSoup(random.integer(1, 6), size, random);
  }
  const double found = sampledDistance(mesh, surface, 50, random);
  const double bound = found * random.uniform(0.7, 1.4);
  const TriangleTree tree(surface);
  SearchBudget budget;
  HausdorffBound check(tree, bound, budget);
  bool is_within = true;
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    const std::optional<Vector3> violation = check.findViolation(cornersOf(mesh, triangle));
    is_within = is_within && !violation;
    if (!violation) continue;
    RC_ASSERT(distanceToSurface(*violation, surface) > bound * (1 - kResolution));
    const auto& [a, b, c] = cornersOf(mesh, triangle);
    RC_ASSERT(distanceToTriangle(*violation, a, b, c) < 1e-12 * size);
  }
  RC_CLASSIFY(is_within);
  if (is_within) RC_ASSERT(sampledDistance(mesh, surface, 300, random, bound) <= bound);
}

}  // namespace
}  // namespace taxelsim
