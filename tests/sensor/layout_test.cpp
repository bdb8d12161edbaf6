

#include "sensor/example_sensor.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kRounding = 1e-17;  // of coordinates below 0.05 m after one rotation

TEST(Layout, CountsTaxelsOfAllPatches) {
  Sensor sensor = exampleSensor();
  EXPECT_EQ(numTaxels(sensor), 84);
  sensor.patches.push_back({.name = "tip", .num_rows = 3, .num_cols = 1, .pitch = {0.001, 0.002}, .X_SP = {}});
  EXPECT_EQ(numTaxels(sensor), 87);
  EXPECT_EQ(taxelPositions(sensor).size(), 87u);
}

TEST(Layout, RowsAreAlongXAndColumnsAlongY) {
  const std::vector<Vector3> positions = taxelPositions(exampleSensor());
  EXPECT_NEAR(positions[0][0], -2.5 * 0.0034, kRounding);
  EXPECT_NEAR(positions[0][1], -6.5 * 0.0034, kRounding);
  EXPECT_NEAR(positions[1][1] - positions[0][1], 0.0034, 2 * kRounding);   // next column
  EXPECT_NEAR(positions[14][0] - positions[0][0], 0.0034, 2 * kRounding);  // next row
  Vector3 sum{0, 0, 0};
  for (const Vector3& p : positions) {
    for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += p[axis];
  }
  for (const double s : sum) EXPECT_NEAR(s, 0, 84 * kRounding);
}

TEST(Layout, AppliesThePosesOfPatches) {
  Sensor sensor = exampleSensor();
  sensor.patches[0] = {.name = "side",
                       .num_rows = 2,
                       .num_cols = 1,
                       .pitch = {0.002, 0.005},
                       .X_SP = {{0.01, 0.02, 0.03}, axisAngle({0, 1, 0}, std::numbers::pi / 2)}};  // x of P is -z of S
  const std::vector<Vector3> positions = taxelPositions(sensor);
  EXPECT_NEAR(positions[0][0], 0.01, kRounding);
  EXPECT_NEAR(positions[0][2], 0.031, kRounding);
  EXPECT_NEAR(positions[1][2], 0.029, kRounding);
}

}  // namespace
}  // namespace taxelsim
