#include "taxelsim/pose.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;
// About ten rounding errors of a coordinate of at most 10 m.
constexpr double kRounding = 1e-14;

void expectNear(const Vector3& a, const Vector3& b) {
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], kRounding) << "axis " << axis;
}

bool isNear(const Vector3& a, const Vector3& b) {
  return std::abs(a[0] - b[0]) <= kRounding && std::abs(a[1] - b[1]) <= kRounding && std::abs(a[2] - b[2]) <= kRounding;
}

rc::Gen<Vector3> vector() {
  const auto coordinate = rc::gen::map(rc::gen::inRange(-3000, 3001), [](int x) { return x * 1e-3; });
  return rc::gen::apply([](double x, double y, double z) { return Vector3{x, y, z}; }, coordinate, coordinate, coordinate);
}

rc::Gen<Pose> pose() {
  return rc::gen::apply(
      [](const Vector3& position, const Vector3& axis, int milliradians) {
        return Pose{position, axisAngle(axis == Vector3{0, 0, 0} ? Vector3{1, 0, 0} : axis, milliradians * 1e-3)};
      },
      vector(), vector(), rc::gen::inRange(-6283, 6284));
}

TEST(Pose, AxisAngleIsRightHanded) {
  expectNear(rotate(axisAngle({0, 0, 1}, kPi / 2), {1, 0, 0}), {0, 1, 0});
  expectNear(rotate(axisAngle({1, 0, 0}, kPi / 2), {0, 1, 0}), {0, 0, 1});
  expectNear(rotate(axisAngle({0, 1, 0}, kPi / 2), {0, 0, 1}), {1, 0, 0});
  expectNear(rotate(axisAngle({0, 0, 5}, kPi), {1, 2, 3}), {-1, -2, 3});
}

TEST(Pose, RotatesBeforeItTranslates) {
  const Pose X_AB{{1, 2, 3}, axisAngle({0, 0, 1}, kPi / 2)};
  expectNear(X_AB * Vector3{1, 0, 0}, {1, 3, 3});
}

TEST(Pose, RotationMatrixColumnsAreTheRotatedAxes) {
  const Quaternion R_AB = axisAngle({1, 2, 3}, 0.7);
  const auto m = rotationMatrix(R_AB);
  expectNear({m[0], m[3], m[6]}, rotate(R_AB, {1, 0, 0}));
  expectNear({m[1], m[4], m[7]}, rotate(R_AB, {0, 1, 0}));
  expectNear({m[2], m[5], m[8]}, rotate(R_AB, {0, 0, 1}));
}

TEST(Pose, ProductAppliesTheRightFactorFirst) {
  EXPECT_TRUE(rc::check([] {
    const Pose X_AB = *pose();
    const Pose X_BC = *pose();
    const Vector3 p_C = *vector();
    RC_ASSERT(isNear((X_AB * X_BC) * p_C, X_AB * (X_BC * p_C)));
  }));
}

TEST(Pose, InverseTimesPoseIsTheIdentity) {
  EXPECT_TRUE(rc::check([] {
    const Pose X_AB = *pose();
    const Vector3 p_B = *vector();
    RC_ASSERT(isNear(inverse(X_AB) * (X_AB * p_B), p_B));
    RC_ASSERT(isNear((inverse(X_AB) * X_AB).position, {0, 0, 0}));
  }));
}

TEST(Pose, RotationPreservesLengthAndOrientation) {
  EXPECT_TRUE(rc::check([] {
    const Quaternion R_AB = (*pose()).rotation;
    const auto m = rotationMatrix(R_AB);
    const double determinant = m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
    RC_ASSERT(std::abs(determinant - 1) <= kRounding);
    const Vector3 v = *vector();
    const Vector3 rotated = rotate(R_AB, v);
    RC_ASSERT(std::abs(std::hypot(rotated[0], rotated[1], rotated[2]) - std::hypot(v[0], v[1], v[2])) <= kRounding);
  }));
}

TEST(Pose, ProductOfManyRotationsStaysNormalized) {
  Quaternion q{1, 0, 0, 0};
  const Quaternion step = axisAngle({1, 2, 3}, 0.01);
  for (int i = 0; i < 100000; ++i) q = q * step;
  EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, kRounding);
}

}  // namespace
}  // namespace taxelsim
