#include "geometry/outward.h"

#include <chrono>

#include "geometry/enclosed.h"
#include "geometry/mesh_files.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::boxMesh;
using support::Random;

// Volume of closed meshes with outward winding, m^3: negative for inward winding.
double volumeOf(const Mesh& mesh) {
  double volume = 0;
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const auto &a = mesh.vertices[ia], &b = mesh.vertices[ib], &c = mesh.vertices[ic];
    volume += (a[0] * (double{b[1]} * c[2] - double{b[2]} * c[1]) + a[1] * (double{b[2]} * c[0] - double{b[0]} * c[2]) +
               a[2] * (double{b[0]} * c[1] - double{b[1]} * c[0])) /
              6;
  }
  return volume;
}

Mesh flipped(Mesh mesh, std::size_t first, std::size_t step) {
  for (std::size_t t = first; t < mesh.triangles.size(); t += step) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  return mesh;
}

Mesh merged(Mesh a, const Mesh& b, const std::array<float, 3>& shift) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  for (const auto& [x, y, z] : b.vertices) a.vertices.push_back({x + shift[0], y + shift[1], z + shift[2]});
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({first + i, first + j, first + k});
  return a;
}

// A strip of `num_cells` x `num_across` squares, closed along the strip; `twist`: its end joins its start upside down. `closed`: its two
// sides are joined as well, so that it is a torus (or, twisted, a Klein bottle). Positions are arbitrary but distinct.
Mesh strip(std::uint32_t num_cells, std::uint32_t num_across, bool twist, bool closed) {
  const std::uint32_t width = closed ? num_across : num_across + 1;
  Mesh mesh;
  for (std::uint32_t i = 0; i < num_cells; ++i) {
    const double along = 2 * std::numbers::pi * i / num_cells;
    for (std::uint32_t j = 0; j < width; ++j) {
      const double across = 2 * std::numbers::pi * j / num_across, radius = 3 + std::cos(across);
      mesh.vertices.push_back({static_cast<float>(radius * std::cos(along)), static_cast<float>(radius * std::sin(along)),
                               static_cast<float>(std::sin(across))});
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    const std::uint32_t column = j % width;
    return i < num_cells ? i * width + column : (twist ? (closed ? (width - column) % width : width - 1 - column) : column);
  };
  for (std::uint32_t i = 0; i < num_cells; ++i) {
    for (std::uint32_t j = 0; j < num_across; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TEST(Outward, KeepsAMeshThatIsOutward) {
  const std::optional<Mesh> outward = outwardMesh(brick());
  ASSERT_TRUE(outward);
  EXPECT_EQ(canonical(*outward), canonical(brick()));
  EXPECT_GT(volumeOf(*outward), 0);
}

TEST(Outward, OrientsFlippedTriangles) {
  for (const Mesh& mesh : {flipped(brick(), 0, 1), flipped(brick(), 0, 3), flipped(brick(), 5, 100)}) {
    const std::optional<Mesh> outward = outwardMesh(mesh);
    ASSERT_TRUE(outward);
    EXPECT_EQ(canonical(*outward), canonical(brick()));
  }
  Random random(1);
  const Mesh star = support::icosphere(0.01, 3, 0.3, random);
  Mesh mixed = star;
  for (auto& [a, b, c] : mixed.triangles) {
    if (random.chance(0.5)) std::swap(b, c);
  }
  const std::optional<Mesh> outward = outwardMesh(mixed);
  ASSERT_TRUE(outward);
  EXPECT_EQ(outward->triangles.size(), star.triangles.size());
  EXPECT_NEAR(volumeOf(*outward), std::abs(volumeOf(star)), 1e-12 * std::abs(volumeOf(star)));
}

TEST(Outward, WeldsDuplicatedVerticesAndDropsDegenerateTriangles) {
  Mesh soup;
  for (const auto& t : brick().triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t index : t) soup.vertices.push_back(brick().vertices[index]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  soup.triangles.push_back({0, 1, 0});
  const std::optional<Mesh> outward = outwardMesh(soup);
  ASSERT_TRUE(outward);
  EXPECT_EQ(outward->vertices.size(), 8u);
  EXPECT_EQ(canonical(*outward), canonical(brick()));
}

TEST(Outward, RejectsMeshesThatAreNotClosed) {
  EXPECT_FALSE(outwardMesh({}));
  EXPECT_FALSE(outwardMesh({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}));
  Mesh open = brick();
  open.triangles.pop_back();
  EXPECT_FALSE(outwardMesh(open)) << "one triangle is missing";
  Random random(2);
  EXPECT_FALSE(outwardMesh(support::sheetWithHoles(6, 0.01, 0.1, 0.2, random)));
  Mesh fin = brick();
  fin.vertices.push_back({2, 2, 2});
  fin.triangles.push_back({0, 1, 8});
  EXPECT_FALSE(outwardMesh(fin)) << "three triangles at an edge";
  // Two boxes that share an edge: four triangles there.
  EXPECT_FALSE(outwardMesh(merged(brick(), brick(), {0.5f, 0.25f, 0})));
  EXPECT_FALSE(outwardMesh(merged(brick(), brick(), {0, 0, 0}))) << "the same surface twice";
  // Two boxes that share a vertex only are two components.
  EXPECT_TRUE(outwardMesh(merged(brick(), brick(), {0.5f, 0.25f, 2})));
}

TEST(Outward, RejectsOneSidedSurfaces) {
  const std::optional<Mesh> torus = outwardMesh(strip(12, 6, false, true));
  ASSERT_TRUE(torus);
  EXPECT_GT(volumeOf(*torus), 0);
  EXPECT_FALSE(outwardMesh(strip(12, 6, true, true))) << "Klein bottle";
  EXPECT_FALSE(outwardMesh(strip(12, 1, true, false))) << "Moebius strip";
}

TEST(Outward, OrientsComponentsByTheirOwnVolume) {
  // The second box is far from the origin and wound inwards.
  const std::optional<Mesh> outward = outwardMesh(merged(brick(), flipped(brick(), 0, 1), {100, -50, 7}));
  ASSERT_TRUE(outward);
  EXPECT_EQ(canonical(*outward), canonical(merged(brick(), brick(), {100, -50, 7})));
}

TEST(Outward, RemovesComponentsInsideOfOthers) {
  const Mesh outer = boxMesh({0.03, 0.03, 0.03}), inner = boxMesh({0.02, 0.02, 0.02}), core = boxMesh({0.01, 0.01, 0.01});
  for (const Mesh& cavity : {inner, flipped(inner, 0, 1)}) {
    const std::optional<Mesh> outward = outwardMesh(merged(merged(core, cavity, {}), outer, {}));
    ASSERT_TRUE(outward);
    EXPECT_EQ(canonical(*outward), canonical(*outwardMesh(outer)));
  }
  Random random(3);
  const Mesh ball = support::icosphere(0.01, 3, 0.0, random), seed = support::icosphere(0.001, 1, 0.0, random);
  EXPECT_EQ(outwardMesh(merged(ball, seed, {0.008f, 0, 0}))->triangles.size(), ball.triangles.size());
  EXPECT_EQ(outwardMesh(merged(ball, seed, {0.0099f, 0, 0}))->triangles.size(), ball.triangles.size() + seed.triangles.size());
}

TEST(Outward, KeepsComponentsThatTouchFromOutside) {
  // A small box on each of the six sides of a large one, flush with it, and one in the hole of a torus.
  const Mesh large = boxMesh({2, 2, 2}), small = boxMesh({0.5, 0.5, 0.5});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.25f, 1.25f}) {
      std::array<float, 3> shift{0.125f, 0.125f, 0.125f};
      shift[axis] = side;
      EXPECT_EQ(outwardMesh(merged(large, small, shift))->triangles.size(), 24u) << axis << " " << side;
    }
  }
  const Mesh torus = strip(12, 6, false, true);
  EXPECT_EQ(outwardMesh(merged(torus, small, {}))->triangles.size(), torus.triangles.size() + 12);
}

TEST(Outward, TakesAMillionTrianglesAndThousandsOfComponents) {
  constexpr int kMaxSeconds = 20;  // far above the time needed, far below that of an algorithm in n^2
  const auto start = std::chrono::steady_clock::now();
  const Mesh torus = strip(1000, 500, false, true);
  EXPECT_EQ(outwardMesh(flipped(torus, 0, 2))->triangles.size(), torus.triangles.size());
  Mesh bristles;
  for (int i = 0; i < 50; ++i) {
    for (int j = 0; j < 50; ++j) {
      bristles = merged(std::move(bristles), boxMesh({1, 1, 20}), {2.0f * static_cast<float>(i), 2.0f * static_cast<float>(j), 0});
    }
  }
  EXPECT_EQ(outwardMesh(bristles)->triangles.size(), bristles.triangles.size());
  // In a row along each axis, so that all have the same range of the other two.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Mesh row;
    for (std::uint32_t i = 0; i < 50'000; ++i) {
      for (auto vertex : brick().vertices) {
        vertex[axis] += 4.0f * static_cast<float>(i);
        row.vertices.push_back(vertex);
      }
      for (const auto& [a, b, c] : brick().triangles) row.triangles.push_back({8 * i + a, 8 * i + b, 8 * i + c});
    }
    EXPECT_EQ(outwardMesh(row)->triangles.size(), row.triangles.size()) << axis;
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(kMaxSeconds));
}

TEST(Outward, RefusesWhatWouldTakeTooLong) {
  Mesh shells;
  std::vector<std::uint32_t> component_of;
  for (std::uint32_t i = 0; i < 20; ++i) {
    const double side = 0.01 * (i + 1);
    shells = merged(std::move(shells), boxMesh({side, side, side}), {});
    component_of.insert(component_of.end(), 12, i);
  }
  const std::vector<bool> enclosed = enclosedComponents(shells, component_of, 20);
  EXPECT_EQ(std::ranges::count(enclosed, true), 19);
  EXPECT_EQ(inputError([&] { enclosedComponents(shells, component_of, 20, 100); }),
            "20 parts are inside of each other: it takes too long to tell which");
}

}  // namespace
}  // namespace taxelsim
