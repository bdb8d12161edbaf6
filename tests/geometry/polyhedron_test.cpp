#include "geometry/polyhedron.h"

#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::boxMesh;
using support::Random;

constexpr std::size_t kManyFaces = 1000;
// Tolerance of convexFaces(): four rounding errors (2^-24) of float32 coordinates of at most 20 mm.
constexpr double kRounding = 4 * 0x1p-24 * 0.02;

std::size_t numFaces(const Mesh& mesh, std::size_t max_faces = kManyFaces) {
  const std::optional<std::vector<Face>> faces = convexFaces(mesh, max_faces);
  return faces ? faces->size() : 0;
}

Mesh merged(Mesh a, const Mesh& b, float shift) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  for (const auto& [x, y, z] : b.vertices) a.vertices.push_back({x + shift, y, z});
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({first + i, first + j, first + k});
  return a;
}

// Splits every triangle into four coplanar ones.
Mesh subdivided(const Mesh& mesh) {
  Mesh fine;
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const std::array corners{mesh.vertices[ia], mesh.vertices[ib], mesh.vertices[ic]};
    std::array<std::uint32_t, 6> at{};
    const auto indexOf = [&](const std::array<float, 3>& p) {
      const auto found = std::find(fine.vertices.begin(), fine.vertices.end(), p);
      if (found != fine.vertices.end()) return static_cast<std::uint32_t>(found - fine.vertices.begin());
      fine.vertices.push_back(p);
      return static_cast<std::uint32_t>(fine.vertices.size() - 1);
    };
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& p = corners[c];
      const auto& q = corners[(c + 1) % 3];
      at[c] = indexOf(p);
      at[3 + c] = indexOf({(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2});
    }
    fine.triangles.insert(fine.triangles.end(),
                          {{at[0], at[3], at[5]}, {at[3], at[1], at[4]}, {at[5], at[4], at[2]}, {at[3], at[4], at[5]}});
  }
  return fine;
}

TEST(Polyhedron, BoxHasSixFaces) {
  const std::optional<std::vector<Face>> faces = convexFaces(boxMesh({0.01, 0.02, 0.004}), 6);
  ASSERT_TRUE(faces);
  ASSERT_EQ(faces->size(), 6u);
  const Vector3 half{0.005, 0.01, 0.002};
  for (const auto& [normal, offset] : *faces) {
    const auto axis = static_cast<std::size_t>(
        std::max_element(normal.begin(), normal.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) - normal.begin());
    EXPECT_NEAR(std::abs(normal[axis]), 1, 1e-12);
    EXPECT_NEAR(offset, half[axis], kRounding);
  }
  EXPECT_EQ(numFaces(subdivided(subdivided(boxMesh({0.01, 0.02, 0.004})))), 6u);
}

TEST(Polyhedron, RejectsMeshesWithMoreThanMaxFaces) {
  Random random(1);
  const Mesh sphere = support::icosphere(0.01, 2, 0, random);
  EXPECT_EQ(numFaces(sphere), sphere.triangles.size());
  EXPECT_EQ(numFaces(sphere, sphere.triangles.size() - 1), 0u);
}

TEST(Polyhedron, RejectsMeshesThatAreNotClosedConvexAndConsistent) {
  const Mesh box = boxMesh({0.01, 0.01, 0.01});
  Random random(2);
  EXPECT_EQ(numFaces(support::icosphere(0.01, 2, 0.1, random)), 0u) << "not convex";
  EXPECT_EQ(numFaces(merged(box, box, 0.02f)), 0u) << "two bodies";
  EXPECT_EQ(numFaces({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}), 0u) << "flat";
  Mesh open = box;
  open.triangles.pop_back();
  EXPECT_EQ(numFaces(open), 0u) << "open";
  Mesh inconsistent = box;
  std::swap(inconsistent.triangles[3][0], inconsistent.triangles[3][1]);
  EXPECT_EQ(numFaces(inconsistent), 0u) << "one triangle wound the other way";
  // Two opposite sides of a box, each as a two-sided sheet: closed, but not a convex body.
  Mesh sheets{box.vertices, {}};
  for (const std::size_t t : {0u, 1u, 2u, 3u}) {
    const auto [a, b, c] = box.triangles[t];
    sheets.triangles.insert(sheets.triangles.end(), {{a, b, c}, {a, c, b}});
  }
  EXPECT_EQ(numFaces(sheets), 0u) << "two-sided sheets";
}

TEST(Polyhedron, AcceptsInwardWinding) {
  Mesh box = boxMesh({0.01, 0.01, 0.01});
  for (auto& [a, b, c] : box.triangles) std::swap(a, b);
  EXPECT_EQ(numFaces(box), 6u);
}

TEST(Polyhedron, AllVerticesAreInsideAllHalfSpacesAndThreeLieOnEachFace) {
  EXPECT_TRUE(rc::check([](std::uint64_t seed) {
    Random random(seed);
    const Object object = support::randomPolyhedron(random, 0.02);
    const Mesh& mesh = std::get<Mesh>(object.shape);
    const std::optional<std::vector<Face>> faces = convexFaces(mesh, kManyFaces);
    RC_ASSERT(faces.has_value());
    for (const auto& [normal, offset] : *faces) {
      RC_ASSERT(std::abs(std::hypot(normal[0], normal[1], normal[2]) - 1) < 1e-12);
      int num_on_face = 0;
      for (const auto& [x, y, z] : mesh.vertices) {
        const double height = normal[0] * x + normal[1] * y + normal[2] * z - offset;
        RC_ASSERT(height <= kRounding);
        num_on_face += height >= -kRounding ? 1 : 0;
      }
      RC_ASSERT(num_on_face >= 3);
    }
  }));
}

}  // namespace
}  // namespace taxelsim
