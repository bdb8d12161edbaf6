#include "control/singularity.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kRounding = 1e-12;

// Planar arm with two links of 1 m, joints about z. Singular when stretched.
Manipulator planarArm() {
  Manipulator arm;
  arm.joints = {{.name = "shoulder"}, {.name = "elbow"}};
  ChainJoint shoulder{.joint = 0}, elbow{.joint = 1};
  elbow.X_PJ.position = {1, 0, 0};
  arm.sensors = {{.link = "hand", .chain = {shoulder, elbow}, .X_JS = {{1, 0, 0}, {1, 0, 0, 0}}}};
  arm.selection = {true, true, false, false, false, false};
  return arm;
}

TEST(Singularity, OfAPlanarArm) {
  const Manipulator arm = planarArm();
  for (const double elbow : {0.0, 0.3, 1.2, 2.0}) {
    // Columns of the Jacobian in S: (sin q, 1 + cos q) and (0, 1). Its determinant is sin q, its squared Frobenius norm 3 + 2 cos q.
    const double determinant = std::sin(elbow), squares = 3 + 2 * std::cos(elbow);
    const double smallest = std::sqrt((squares - std::sqrt(squares * squares - 4 * determinant * determinant)) / 2);
    EXPECT_NEAR(smallestSingularValue(arm, std::array{0.7, elbow}), smallest, kRounding) << elbow;
  }
}

TEST(Singularity, OfThePanTiltPlatform) {
  Manipulator platform = panTilt({});
  EXPECT_NEAR(smallestSingularValue(platform, std::array{0.0, 0.0}), 1, kRounding) << "pan and tilt rotate the sensor about z and y";
  // Tilted by 60 degrees, w_z is half of the velocity of the pan joint.
  EXPECT_NEAR(smallestSingularValue(platform, std::array{0.0, std::acos(0.5)}), 0.5, kRounding);
}

}  // namespace
}  // namespace taxelsim
