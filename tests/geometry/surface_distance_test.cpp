// Proof of a bound between surfaces: against closed forms, and over random surfaces against brute force.
#include "geometry/surface_distance.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numbers>

#include "geometry/brute_force_distance.h"
#include "geometry/is_within.h"
#include "support/random_scene.h"

namespace taxelsim {
namespace {

using support::Random;

// A bound is decided to a millionth of itself (findBeyond()), twice that for what float32 vertices of 1 cm take from bounds of 1 mm: 6e-10
// m.
constexpr double kSharpness = 3e-6;

void expectGreatestDistance(const Mesh& mesh, const Mesh& surface, double distance) {
  EXPECT_TRUE(isWithin(mesh, surface, distance * (1 + kSharpness)));
  EXPECT_FALSE(isWithin(mesh, surface, distance * (1 - kSharpness)));
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

TEST(TriangleTree, FindsTheNearestTriangleOfASoup) {
  Random random(1);
  for (const int num_triangles : {1, 3, 5, 40, 333}) {
    const Mesh soup = support::triangleSoup(num_triangles, 0.01, random);
    const TriangleTree tree(soup);
    Effort effort;
    for (int n = 0; n < 200; ++n) {
      const Vector3 p{random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03)};
      const double distance = distanceToSurface(p, soup);
      const std::optional<TriangleTree::Nearest> nearest = tree.nearest(p, 1, effort);
      ASSERT_TRUE(nearest);
      // Rounding of some twenty operations in double on coordinates below 0.1 m.
      constexpr double kTolerance = 1e-15;
      EXPECT_NEAR(nearest->distance, distance, kTolerance);
      const auto& [a, b, c] = tree.corners(nearest->triangle);
      EXPECT_NEAR(distanceToTriangle(p, a, b, c), distance, kTolerance);
      EXPECT_FALSE(tree.nearest(p, distance * (1 - 1e-9), effort));
      EXPECT_TRUE(tree.nearest(p, distance * (1 + 1e-9), effort));
    }
    EXPECT_GT(effort.spent, 0u);
  }
}

TEST(TriangleTree, MeasuresToTrianglesWithoutAreaToo) {
  const Vector3 a{0, 0, 0}, b{2, 0, 0}, c{1, 0, 0};
  EXPECT_EQ(squaredDistance({1, 1, 0}, {a, a, a}), 2);
  EXPECT_EQ(squaredDistance({1, 1, 0}, {a, b, b}), 1);
  EXPECT_EQ(squaredDistance({1, 1, 0}, {a, b, c}), 1);
  EXPECT_EQ(squaredDistance({3, 0, 0}, {c, a, b}), 1);
}

TEST(BoundCheck, ParallelPlanes) {
  // Triangles of one are small or large beside those of the other, and cut across them.
  for (const auto& [one, other] : {std::pair{1, 1}, {1, 7}, {7, 1}, {7, 10}, {2, 60}, {60, 2}}) {
    expectGreatestDistance(plane(one, 0), plane(other, 0.001f), 0.001f);
  }
}

TEST(BoundCheck, ASurfaceIsOnItself) {
  Random random(2);
  const Mesh soup = support::triangleSoup(100, 0.01, random);
  EXPECT_TRUE(isWithin(soup, soup, 1e-12));
  EXPECT_FALSE(isWithin(soup, soup, 0));  // nothing can be proven below rounding
}

TEST(BoundCheck, WhatHangsOverAnEdge) {
  Mesh larger = plane(5, 0.001f);
  for (auto& vertex : larger.vertices) vertex[0] *= 1.5f;  // 2.5 mm beyond on both sides
  expectGreatestDistance(larger, plane(3, 0), std::hypot(0.0025, 0.001));
  expectGreatestDistance(plane(3, 0), larger, 0.001f);
}

// The corners of the lid lie on the roof, whose ridge is 1 mm above: only the middle of the lid tells.
TEST(BoundCheck, BetweenTheCornersUnderARoof) {
  const Mesh roof{
      {{-0.005f, -0.01f, 0}, {-0.005f, 0.01f, 0}, {0, -0.01f, 0.001f}, {0, 0.01f, 0.001f}, {0.005f, -0.01f, 0}, {0.005f, 0.01f, 0}},
      {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}}};
  const Mesh lid{{{-0.005f, -0.005f, 0}, {0.005f, -0.005f, 0}, {0.005f, 0.005f, 0}, {-0.005f, 0.005f, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  // From the middle square to the roof's slope: 1 mm x cos(atan(1 / 5)).
  expectGreatestDistance(lid, roof, 0.001 * 5 / std::sqrt(26.0));
}

TEST(BoundCheck, ConcentricSpheres) {
  Random random(3);
  const Mesh inner = support::icosphere(0.01, 3, 0, random);
  const Mesh outer = scaled(inner, 1.0625f);  // exact in float32 but for the last bit
  // A corner's nearest point on the smaller one is the same corner; everything else is nearer.
  expectGreatestDistance(outer, inner, 0.0625 * 0.01);
  EXPECT_TRUE(isWithin(inner, outer, 0.0625 * 0.01));
  // The finer sphere's corners lie on the sphere, at most one sagitta over the triangles of the coarser one: r - sqrt(r^2 - c^2), c the
  // circumradius of the largest triangle. Edges of a level-2 icosphere are at most 0.325 r, its triangles nearly regular: c < 0.19 r.
  const Mesh coarse = support::icosphere(0.01, 2, 0, random), fine = support::icosphere(0.01, 4, 0, random);
  EXPECT_TRUE(isWithin(fine, coarse, 0.01 * (1 - std::sqrt(1 - 0.19 * 0.19))));
  EXPECT_FALSE(isWithin(fine, coarse, 0.01 * (1 - std::sqrt(1 - 0.15 * 0.15))));
}

TEST(BoundCheck, NothingIsNearAnEmptySurface) {
  EXPECT_FALSE(isWithin(plane(1, 0), {}, 1));
  EXPECT_TRUE(isWithin({}, plane(1, 0), 1e-9));
}

TEST(BoundCheck, ProvesNothingWhenExhausted) {
  const Mesh mesh = plane(9, 0), surface = plane(7, 0);
  const TriangleTree tree(surface);
  Effort effort{.max = 20};
  BoundCheck check(tree, 1e-5, effort);
  std::size_t num_proven = 0;
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) num_proven += !check.findBeyond(cornersOf(mesh, triangle));
  EXPECT_TRUE(effort.isExhausted());
  EXPECT_LT(num_proven, 5u);
}

// Random pairs of surfaces near to each other: what is proven must hold at every sample, and a point that is beyond must be there.
RC_GTEST_PROP(BoundCheckOverRandomSurfaces, AgreesWithBruteForce, (std::uint32_t seed)) {
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
  Effort effort;
  BoundCheck check(tree, bound, effort);
  bool is_within = true;
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    const std::optional<Vector3> beyond = check.findBeyond(cornersOf(mesh, triangle));
    is_within = is_within && !beyond;
    if (!beyond) continue;
    RC_ASSERT(distanceToSurface(*beyond, surface) > bound * (1 - kSharpness));
    const auto& [a, b, c] = cornersOf(mesh, triangle);
    RC_ASSERT(distanceToTriangle(*beyond, a, b, c) < 1e-12 * size);
  }
  RC_CLASSIFY(is_within);
  if (is_within) RC_ASSERT(sampledDistance(mesh, surface, 300, random, bound) <= bound);
}

}  // namespace
}  // namespace taxelsim
