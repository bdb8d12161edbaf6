#include "geometry/triangulate.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using Vertices = std::vector<Triangulator::Vertex>;
using Triangles = std::vector<Triangulator::Triangle>;

// Twice the area along z.
double areaOf(const Vertices& v, const Triangulator::Triangle& t) {
  const auto side = [&](std::uint32_t corner, int axis) {
    return static_cast<double>(v[corner][axis]) - static_cast<double>(v[t[0]][axis]);
  };
  return side(t[1], 0) * side(t[2], 1) - side(t[1], 1) * side(t[2], 0);
}

Triangles triangulated(const Vertices& vertices) {
  std::vector<std::uint32_t> corners(vertices.size());
  std::iota(corners.begin(), corners.end(), 0u);
  Triangles triangles;
  EXPECT_TRUE(Triangulator()(vertices, corners, triangles));
  return triangles;
}

TEST(Triangulate, ConvexPolygonsGiveAFan) {
  EXPECT_EQ(triangulated({{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0}}), (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(triangulated({{0, 0, 0}, {1, 0, 0}}), Triangles());
}

TEST(Triangulate, ConcaveQuadsAreCutAtTheirConcaveCorner) {
  // (0, 0), (2, 0), (0.5, 0.5), (0, 2): the cut 1-3 would be outside.
  for (const auto& triangle : triangulated({{0, 0, 0}, {2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}}))
    EXPECT_NE(std::find(triangle.begin(), triangle.end(), 2u), triangle.end());
}

// A polygon around the origin with random radii: all its triangles are positive and their areas add up to its own.
RC_GTEST_PROP(TriangulateProperty, KeepsTheAreaOfAnyStar, ()) {
  const auto radii =
      *rc::gen::suchThat(rc::gen::container<std::vector<int>>(rc::gen::inRange(1, 100)), [](const auto& all) { return all.size() >= 4; });
  Vertices vertices;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(radii.size());
    vertices.push_back({static_cast<float>(radii[i] * std::cos(angle)), static_cast<float>(radii[i] * std::sin(angle)), 0});
  }
  double expected = 0, sum = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto &a = vertices[i], &b = vertices[(i + 1) % vertices.size()];
    expected += static_cast<double>(a[0]) * static_cast<double>(b[1]) - static_cast<double>(a[1]) * static_cast<double>(b[0]);
  }
  const Triangles triangles = triangulated(vertices);
  RC_ASSERT(triangles.size() == vertices.size() - 2);
  for (const auto& triangle : triangles) {
    RC_ASSERT(areaOf(vertices, triangle) >= 0);
    sum += areaOf(vertices, triangle);
  }
  constexpr double kTolerance = 1e-12;  // 100 products in double, of exact float32 coordinates: 1e2 x 2^-53 and a margin of 100
  RC_ASSERT(std::abs(sum - expected) <= kTolerance * expected);
}

TEST(Triangulate, EndsOnHostilePolygons) {
  // Of all corners equal, and of one that crosses itself everywhere.
  EXPECT_LE(triangulated(Vertices(kMaxPolygonCorners, {1, 1, 1})).size(), kMaxPolygonCorners);
  Vertices star;
  for (std::size_t i = 0; i < 999; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) * 499 / 999;
    star.push_back({static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle) * (i % 2 == 0 ? 1 : -1)), 0});
  }
  EXPECT_LE(triangulated(star).size(), star.size());
}

}  // namespace
}  // namespace taxelsim
