#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <numbers>

#include "geometry/mesh_files.h"
#include "geometry/solids.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;
const Quaternion kAsIs{1, 0, 0, 0};

// Dimensions below are up to 1 m; rotation and product cost some rounding errors of that.
constexpr double kRounding = 1e-14;
// An edge within 1e-6 rad of level counts as level (lowest_point.cpp): its middle is up to that times half its length too high. Sizes are
// below 3 m.
constexpr double kLevelHeight = 3e-6;

void expectPoint(const Shape& shape, const Quaternion& R_SO, const Vector3& expected) {
  const Vector3 p = lowestPoint(shape, R_SO);
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(p[axis], expected[axis], kRounding) << Object(shape).name << " axis " << axis;
}

TEST(LowestPoint, ClosedFormsAsTheyStand) {
  expectPoint(Sphere{0.3}, kAsIs, {0, 0, -0.3});
  expectPoint(Cylinder{0.2, 0.6}, kAsIs, {0, 0, -0.3});  // middle of the flat end
  expectPoint(Capsule{0.2, 0.6}, kAsIs, {0, 0, -0.5});
  expectPoint(Box{{0.1, 0.2, 0.4}}, kAsIs, {0, 0, -0.2});  // middle of the face
  expectPoint(HalfSpace{}, kAsIs, {0, 0, 0});
  expectPoint(Cone{0.2, 0.4}, kAsIs, {0, 0, 0});      // apex
  expectPoint(Torus{0.3, 0.1}, kAsIs, {0, 0, -0.1});  // middle of the lowest circle
  expectPoint(brick(), kAsIs, {0.25, 0.125, 0});      // mean of four corners
}

TEST(LowestPoint, LyingOnASideGivesItsMiddle) {
  const Quaternion quarter = axisAngle({1, 0, 0}, kPi / 2);  // y of O up, z of O to -y of S
  expectPoint(Cylinder{0.2, 0.6}, quarter, {0, -0.2, 0});
  expectPoint(Capsule{0.2, 0.6}, quarter, {0, -0.2, 0});
  expectPoint(Box{{0.1, 0.2, 0.4}}, quarter, {0, -0.1, 0});
  expectPoint(Torus{0.3, 0.1}, quarter, {0, -0.4, 0});
  const Quaternion half = axisAngle({1, 0, 0}, kPi);
  expectPoint(Cone{0.2, 0.4}, half, {0, 0, 0.4});  // middle of the base
  // A cone on its mantle: the slant line from apex to rim is lowest.
  expectPoint(Cone{0.3, 0.4}, axisAngle({1, 0, 0}, std::atan2(0.4, 0.3)), {0, -0.15, 0.2});
}

TEST(LowestPoint, AnEdgeDownGivesTheMiddleOfTheEdge) {
  const Quaternion eighth = axisAngle({1, 0, 0}, kPi / 4);
  expectPoint(Box{{0.1, 0.2, 0.4}}, eighth, {0, -0.1, -0.2});
  expectPoint(brick(), eighth, {0.25, 0, 0});
  const Vector3 p = lowestPoint(Cylinder{0.2, 0.6}, eighth);  // one point of the rim
  EXPECT_NEAR(p[1], -0.2, kRounding);
  EXPECT_NEAR(p[2], -0.3, kRounding);
}

TEST(LowestPoint, SevenTypedDigitsStillCountAsLevel) {
  expectPoint(Box{{0.1, 0.2, 0.4}}, {0.7071068, 0.7071068, 0, 0}, {0, -0.1, 0});
  expectPoint(Box{{0.1, 0.2, 0.4}}, {0.9238795, 0.3826834, 0, 0}, {0, -0.1, -0.2});
}

TEST(LowestPoint, AHalfSpaceThatFacesAwayHasNone) {
  expectPoint(HalfSpace{}, axisAngle({1, 0, 0}, 0.3), {0, 0, 0});
  EXPECT_NE(inputError([] { lowestPoint(HalfSpace{}, axisAngle({1, 0, 0}, kPi)); }), "");
  EXPECT_NE(inputError([] { lowestPoint(HalfSpace{}, axisAngle({0, 1, 0}, kPi / 2)); }), "");
}

TEST(LowestPoint, LeavesOutVerticesThatNoTriangleUses) {
  Mesh mesh = brick();
  mesh.vertices.push_back({0, 0, -5});
  EXPECT_EQ(lowestPoint(mesh, kAsIs), (Vector3{0.25, 0.125, 0}));
}

rc::Gen<double> length() {
  return rc::gen::map(rc::gen::inRange(1, 1001), [](int thousandths) { return thousandths * 1e-3; });
}

// Multiples of 15 degrees about an axis with small whole coordinates half of the time, so that ties turn up; anything otherwise.
rc::Gen<Quaternion> rotation() {
  return rc::gen::exec([] {
    Vector3 axis{static_cast<double>(*rc::gen::inRange(-2, 3)), static_cast<double>(*rc::gen::inRange(-2, 3)),
                 static_cast<double>(*rc::gen::inRange(-2, 3))};
    if (axis == Vector3{0, 0, 0}) axis = {0, 0, 1};
    if (*rc::gen::arbitrary<bool>()) return axisAngle(axis, *rc::gen::inRange(0, 24) * kPi / 12);
    for (double& component : axis) component += *rc::gen::inRange(-1000, 1001) * 1e-3 + 1e-4;
    return axisAngle(axis, *rc::gen::inRange(0, 62832) * 1e-4);
  });
}

rc::Gen<Shape> solid() {
  return rc::gen::exec([]() -> Shape {
    const double a = *length(), b = *length(), c = *length();
    switch (*rc::gen::inRange(0, 7)) {
      case 0:
        return Sphere{a};
      case 1:
        return Cylinder{a, b};
      case 2:
        return Capsule{a, b};
      case 3:
        return Box{{a, b, c}};
      case 4:
        return Cone{a, b};
      case 5:
        return Torus{a + b, b};
      default: {
        Mesh mesh = brick();
        for (Corner& v : mesh.vertices)
          v = {v[0] * static_cast<float>(a), v[1] * static_cast<float>(b), v[2] * 0.5f * static_cast<float>(c)};
        return mesh;
      }
    }
  });
}

// The two oracles: the point belongs to the solid, and no point of the surface is lower. Both are exact; brute force need not hit the
// minimum.
TEST(LowestPoint, IsOnTheSolidAndNoPointIsLower) {
  EXPECT_TRUE(rc::check([] {
    const Shape shape = *solid();
    const Quaternion R_SO = *rotation();
    const Vector3 p = lowestPoint(shape, R_SO);
    const double height = rotate(R_SO, p)[2];

    const bool whole_circle = std::holds_alternative<Torus>(shape) && std::hypot(p[0], p[1]) < 1e-6;
    if (!whole_circle) RC_ASSERT(std::abs(std::visit(Outside{p}, shape)) <= kRounding);
    double lowest = 1e9;
    for (const Vector3& point : std::visit(SurfacePoints{}, shape)) lowest = std::min(lowest, rotate(R_SO, point)[2]);
    RC_ASSERT(height <= lowest + kLevelHeight);
    // A mesh has its lowest vertices among the points, so the two agree.
    if (std::holds_alternative<Mesh>(shape)) RC_ASSERT(height >= lowest - kRounding);
  }));
}

// Turning the object about the vertical does not change which of its points is lowest.
TEST(LowestPoint, DoesNotDependOnYaw) {
  EXPECT_TRUE(rc::check([] {
    const Shape shape = *solid();
    const Quaternion R_SO = *rotation();
    const Quaternion turned = axisAngle({0, 0, 1}, *rc::gen::inRange(0, 6283) * 1e-3) * R_SO;
    const double height = rotate(R_SO, lowestPoint(shape, R_SO))[2];
    RC_ASSERT(std::abs(rotate(turned, lowestPoint(shape, turned))[2] - height) <= kLevelHeight);
  }));
}

}  // namespace
}  // namespace taxelsim
