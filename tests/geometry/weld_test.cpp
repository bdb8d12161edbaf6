#include "geometry/weld.h"

#include "geometry/mesh_files.h"
#include "support/test.h"

namespace taxelsim {
namespace {

Mesh unwelded(const Mesh& mesh) {
  Mesh result;
  for (const auto& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(result.vertices.size());
    for (const std::uint32_t index : t) result.vertices.push_back(mesh.vertices[index]);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

TEST(Weld, MergesEqualPositionsOnly) {
  const Mesh mesh = weld(unwelded(brick()));
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_EQ(canonical(mesh), canonical(brick()));

  Mesh close = unwelded(brick());
  close.vertices[0][0] = std::nextafter(close.vertices[0][0], 1.0f);
  EXPECT_EQ(weld(close).vertices.size(), 9u);
}

TEST(Weld, TreatsMinusZeroAsZero) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0f, 0, -0.0f}, {0, 1, 1}, {0, 0, 1}}, {{0, 1, 2}, {3, 4, 5}}};
  EXPECT_EQ(weld(mesh).vertices.size(), 5u);
}

TEST(Weld, KeepsSliversAndDropsDegenerateTriangles) {
  const float tiny = std::numeric_limits<float>::denorm_min();
  EXPECT_EQ(weld({{{0, 0, 0}, {1, 0, 0}, {0, tiny, 0}}, {{0, 1, 2}}}).triangles.size(), 1u);
  EXPECT_TRUE(weld({{{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}, {{0, 1, 2}}}).triangles.empty());
  EXPECT_TRUE(weld({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 0}}}).triangles.empty());
  EXPECT_TRUE(weld({}).triangles.empty());
}

TEST(Weld, IsIdempotentAndKeepsAllTrianglesWithArea) {
  EXPECT_TRUE(rc::check([](const std::vector<std::array<std::uint8_t, 9>>& triangles) {
    Mesh mesh;
    for (const auto& t : triangles) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto coordinate = [&](std::size_t axis) { return static_cast<float>(t[3 * corner + axis] % 4); };
        mesh.vertices.push_back({coordinate(0), coordinate(1), coordinate(2)});
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
    const Mesh once = weld(mesh);
    std::vector<Corner> positions = once.vertices;
    std::sort(positions.begin(), positions.end());
    RC_ASSERT(std::adjacent_find(positions.begin(), positions.end()) == positions.end());
    RC_ASSERT(weld(once).vertices == once.vertices);
    RC_ASSERT(weld(once).triangles == once.triangles);
    // Only degenerate triangles were dropped. Coordinates are small integers, so this check in float is exact.
    std::size_t num_with_area = 0;
    for (const auto& t : mesh.triangles) {
      const Corner &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
      const auto cross = [&](std::size_t i, std::size_t j) { return (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]); };
      num_with_area += cross(0, 1) != 0 || cross(1, 2) != 0 || cross(2, 0) != 0;
    }
    RC_ASSERT(once.triangles.size() == num_with_area);
  }));
}

}  // namespace
}  // namespace taxelsim
