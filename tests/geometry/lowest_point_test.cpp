

#include "geometry/mesh_files.h"
#include "geometry/solids.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;
const Quaternion kIdentity{1, 0, 0, 0};

// A few rounding errors of dimensions of at most 1 m.
constexpr double kRounding = 1e-14;
// The midpoint of an edge within 1e-6 rad of the plane z = 0 is up to 1e-6 times half its length above its lower end (kParallelAngle in
// lowest_point.cpp). Sizes are below 3 m.
constexpr double kMidpointHeight = 3e-6;

void expectPoint(const Shape& shape, const Quaternion& R_SO, const Vector3& expected) {
  const Vector3 p = lowestPoint(shape, R_SO);
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(p[axis], expected[axis], kRounding) << Object(shape).name << " axis " << axis;
}

TEST(LowestPoint, OfUnrotatedShapes) {
  expectPoint(Sphere{0.3}, kIdentity, {0, 0, -0.3});
  expectPoint(Cylinder{0.2, 0.6}, kIdentity, {0, 0, -0.3});  // center of the end
  expectPoint(Capsule{0.2, 0.6}, kIdentity, {0, 0, -0.5});
  expectPoint(Box{{0.1, 0.2, 0.4}}, kIdentity, {0, 0, -0.2});  // center of the face
  expectPoint(HalfSpace{}, kIdentity, {0, 0, 0});
  expectPoint(Cone{0.2, 0.4}, kIdentity, {0, 0, 0});      // apex
  expectPoint(Torus{0.3, 0.1}, kIdentity, {0, 0, -0.1});  // center of the lowest circle
  expectPoint(brick(), kIdentity, {0.25, 0.125, 0});      // mean of four corners
}

TEST(LowestPoint, OfAShapeOnItsSideIsTheMidpointOfTheSide) {
  const Quaternion quarter = axisAngle({1, 0, 0}, kPi / 2);  // y of O along z of S, z of O along -y of S
  expectPoint(Cylinder{0.2, 0.6}, quarter, {0, -0.2, 0});
  expectPoint(Capsule{0.2, 0.6}, quarter, {0, -0.2, 0});
  expectPoint(Box{{0.1, 0.2, 0.4}}, quarter, {0, -0.1, 0});
  expectPoint(Torus{0.3, 0.1}, quarter, {0, -0.4, 0});
  const Quaternion half = axisAngle({1, 0, 0}, kPi);
  expectPoint(Cone{0.2, 0.4}, half, {0, 0, 0.4});  // center of the base
  // A cone on its lateral surface: the line from apex to rim is lowest.
  expectPoint(Cone{0.3, 0.4}, axisAngle({1, 0, 0}, std::atan2(0.4, 0.3)), {0, -0.15, 0.2});
}

TEST(LowestPoint, OfAShapeOnAnEdgeIsTheMidpointOfTheEdge) {
  const Quaternion eighth = axisAngle({1, 0, 0}, kPi / 4);
  expectPoint(Box{{0.1, 0.2, 0.4}}, eighth, {0, -0.1, -0.2});
  expectPoint(brick(), eighth, {0.25, 0, 0});
  const Vector3 p = lowestPoint(Cylinder{0.2, 0.6}, eighth);  // one point of the rim
  EXPECT_NEAR(p[1], -0.2, kRounding);
  EXPECT_NEAR(p[2], -0.3, kRounding);
}

TEST(LowestPoint, QuaternionsWithSevenDigitsCountAsParallel) {
  expectPoint(Box{{0.1, 0.2, 0.4}}, {0.7071068, 0.7071068, 0, 0}, {0, -0.1, 0});
  expectPoint(Box{{0.1, 0.2, 0.4}}, {0.9238795, 0.3826834, 0, 0}, {0, -0.1, -0.2});
}

TEST(LowestPoint, RejectsAHalfSpaceThatDoesNotFaceTheSkin) {
  expectPoint(HalfSpace{}, axisAngle({1, 0, 0}, 0.3), {0, 0, 0});
  EXPECT_NE(inputError([] { lowestPoint(HalfSpace{}, axisAngle({1, 0, 0}, kPi)); }), "");
  EXPECT_NE(inputError([] { lowestPoint(HalfSpace{}, axisAngle({0, 1, 0}, kPi / 2)); }), "");
}

TEST(LowestPoint, IgnoresUnusedVertices) {
  Mesh mesh = brick();
  mesh.vertices.push_back({0, 0, -5});
  EXPECT_EQ(lowestPoint(mesh, kIdentity), (Vector3{0.25, 0.125, 0}));
}

rc::Gen<double> length() {
  return rc::gen::map(rc::gen::inRange(1, 1001), [](int thousandths) { return thousandths * 1e-3; });
}

// In half of the cases a multiple of 15 degrees about an axis with small integer coordinates, so that ties occur; an
// arbitrary rotation otherwise.
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

// The point lies on the solid, and no sampled point of the surface is lower. The samples need not include the minimum.
TEST(LowestPoint, IsOnTheSolidAndNoPointIsLower) {
  EXPECT_TRUE(rc::check([] {
    const Shape shape = *solid();
    const Quaternion R_SO = *rotation();
    const Vector3 p = lowestPoint(shape, R_SO);
    const double height = rotate(R_SO, p)[2];

    const bool whole_circle = std::holds_alternative<Torus>(shape) && std::hypot(p[0], p[1]) < 1e-6;
    if (!whole_circle) RC_ASSERT(std::abs(std::visit(ImplicitFunction{p}, shape)) <= kRounding);
    double lowest = 1e9;
    for (const Vector3& point : std::visit(SurfacePoints{}, shape)) lowest = std::min(lowest, rotate(R_SO, point)[2]);
    RC_ASSERT(height <= lowest + kMidpointHeight);
    // The samples of a mesh include its lowest vertices.
    if (std::holds_alternative<Mesh>(shape)) RC_ASSERT(height >= lowest - kRounding);
  }));
}

// A rotation about the vertical does not change the height of the lowest point.
TEST(LowestPoint, HeightDoesNotDependOnYaw) {
  EXPECT_TRUE(rc::check([] {
    const Shape shape = *solid();
    const Quaternion R_SO = *rotation();
    const Quaternion rotated = axisAngle({0, 0, 1}, *rc::gen::inRange(0, 6283) * 1e-3) * R_SO;
    const double height = rotate(R_SO, lowestPoint(shape, R_SO))[2];
    RC_ASSERT(std::abs(rotate(rotated, lowestPoint(shape, rotated))[2] - height) <= kMidpointHeight);
  }));
}

}  // namespace
}  // namespace taxelsim
