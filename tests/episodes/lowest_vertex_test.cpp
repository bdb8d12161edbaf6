#include "episodes/lowest_vertex.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kSummation = 1e-13;  // m: sums of some hundred vertices below 1 m in different orders

double drawBetween(double min, double max) {
  return min + (max - min) * (*rc::gen::inRange(0, 1 << 20)) / static_cast<double>(1 << 20);
}

Quaternion drawRotation() {
  return axisAngle({drawBetween(0.01, 1), drawBetween(-1, 1), drawBetween(-1, 1)}, drawBetween(-4, 4));
}

void assertSame(const Object& object, const Quaternion& R_SO) {
  const Vector3 expected = lowestPoint(object, R_SO);
  const Vector3 found = LowestVertex(object).find(R_SO);
  for (int k = 0; k < 3; ++k) RC_ASSERT(std::abs(found[k] - expected[k]) <= kSummation);
}

RC_GTEST_PROP(LowestVertexProperty, MatchesLowestPointOnTriangleSoups, ()) {
  Mesh mesh;
  const std::uint32_t num_vertices = *rc::gen::inRange(3, 300);
  for (std::uint32_t i = 0; i < num_vertices; ++i) {
    mesh.vertices.push_back(
        {static_cast<float>(drawBetween(-1, 1)), static_cast<float>(drawBetween(-1, 1)), static_cast<float>(drawBetween(-1, 1))});
  }
  // Some vertices are used by no triangle and must be ignored.
  const int num_triangles = *rc::gen::inRange(1, 150);
  for (int i = 0; i < num_triangles; ++i) {
    mesh.triangles.push_back(
        {*rc::gen::inRange(0u, num_vertices), *rc::gen::inRange(0u, num_vertices), *rc::gen::inRange(0u, num_vertices)});
  }
  assertSame(Object(mesh), drawRotation());
}

// Rotations of a cubic grid by multiples of 45 degrees: a face, an edge or a corner is lowest.
RC_GTEST_PROP(LowestVertexProperty, MatchesLowestPointOnLevelFaces, ()) {
  Mesh mesh;
  constexpr int kSide = 7;
  for (int x = 0; x < kSide; ++x) {
    for (int y = 0; y < kSide; ++y) {
      for (int z = 0; z < kSide; ++z) {
        mesh.vertices.push_back({static_cast<float>(x) * 0.01f, static_cast<float>(y) * 0.01f, static_cast<float>(z) * 0.01f});
      }
    }
  }
  for (std::uint32_t i = 0; i + 2 < mesh.vertices.size(); ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  const double eighth = std::acos(0.0) / 2;
  const Quaternion R_SO = axisAngle({1, 0, 0}, eighth * *rc::gen::inRange(0, 8)) * axisAngle({0, 1, 0}, eighth * *rc::gen::inRange(0, 8));
  assertSame(Object(mesh), R_SO);
}

TEST(LowestVertex, DelegatesSolidsToLowestPoint) {
  const Object cone(Cone{.radius = 0.01, .height = 0.02});
  const Quaternion R_SO = axisAngle({1, 0.2, 0}, 2.5);
  EXPECT_EQ(LowestVertex(cone).find(R_SO), lowestPoint(cone, R_SO));
}

}  // namespace
}  // namespace taxelsim
