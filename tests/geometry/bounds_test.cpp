

#include "geometry/mesh_files.h"
#include "geometry/solids.h"
#include "support/test.h"

namespace taxelsim {
namespace {

// The sampled points include every extreme: 48 points of a circle include the four axis directions. Only rounding remains.
constexpr double kRounding = 1e-15;

void expectTight(const Object& object) {
  Vector3 low{9, 9, 9};
  Vector3 high{-9, -9, -9};
  for (const Vector3& p : std::visit(SurfacePoints{}, object.shape)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  const Bounds bounds = boundsOf(object);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(bounds.min[axis], low[axis], kRounding) << object.name;
    EXPECT_NEAR(bounds.max[axis], high[axis], kRounding) << object.name;
  }
}

TEST(BoundsOf, AreTheExtremesOfTheSurface) {
  expectTight(brick());
  expectTight(Sphere{0.3});
  expectTight(Cylinder{0.2, 0.7});
  expectTight(Capsule{0.2, 0.5});
  expectTight(Box{{0.1, 0.2, 0.3}});
  expectTight(Cone{0.2, 0.4});
  expectTight(Torus{0.3, 0.1});
}

TEST(BoundsOf, AreInfiniteForAHalfSpace) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(boundsOf(HalfSpace{}).min, (Vector3{-kInfinity, -kInfinity, 0}));
  EXPECT_EQ(boundsOf(HalfSpace{}).max, (Vector3{kInfinity, kInfinity, kInfinity}));
}

TEST(BoundsOf, IgnoreUnusedVertices) {
  Mesh mesh = brick();
  mesh.vertices.push_back({100, 100, 100});
  EXPECT_EQ(boundsOf(mesh).max, (Vector3{0.5, 0.25, 2}));
}

}  // namespace
}  // namespace taxelsim
