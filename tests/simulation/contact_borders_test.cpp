// Which taxel takes a contact point on a border: the half-open cells of paper eq. (2).
#include "reference/contact_points.h"
#include "simulation/comparison.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kDt = 1e-3;  // s
constexpr OutputOptions kNoDepth{.penetration_depth = false};

using Contacts = std::vector<ContactPoint>;

// With a pitch of 2^-8 m all borders are exact in float32. Each contact has a force of 1 N, so that the forces show which taxel took it.
class BordersOnEveryDriver : public ::testing::Test {
 protected:
  static constexpr double kPitch = 0x1p-8;  // m
  Sensor sensor_ = support::gridSensor({.num_rows = 3, .num_cols = 4, .pitch_x = kPitch, .pitch_y = kPitch, .thickness = 0x1p-9});
  Model model_{support::sharedDevice(), {.sensor = sensor_}};
  Simulator simulator_{model_, {.outputs = kNoDepth, .max_contacts = 64, .contact_band = 0x1p-13}};

  // Force on each taxel, then the force off the array as last element.
  std::vector<double> forcesOf(const Contacts& contacts) {
    simulator_.setContacts(0, contacts);
    const FrameView frame = support::stepOnce(simulator_, kDt);
    std::vector<double> forces(frame.ground_truth.tactile_normal_force.begin(), frame.ground_truth.tactile_normal_force.end());
    forces.push_back(frame.ground_truth.off_array_load[0]);
    return forces;
  }
  // Expects the whole force of one contact on `taxel`; -1: off the array.
  void expectTaxel(double x, double y, double z, int taxel) {
    std::vector<double> expected(13, 0);
    expected[taxel < 0 ? 12 : static_cast<std::size_t>(taxel)] = 1;
    EXPECT_EQ(forcesOf({{{x, y, z}, 1}}), expected) << x / kPitch << " " << y / kPitch << " " << z / kPitch;
    const std::optional<int> by_twin = reference::taxelAt(sensor_, {x, y, z}, 0x1p-13);
    EXPECT_EQ(by_twin.value_or(-1), taxel);
  }
};

TEST_F(BordersOnEveryDriver, HigherIndexTakesTheBorder) {
  // Borders along x at -1/2 and 1/2 pitches, along y at -1, 0 and 1.
  expectTaxel(-kPitch / 2, 0.5 * kPitch, 0, 1 * 4 + 2);
  expectTaxel(kPitch / 2, 0.5 * kPitch, 0, 2 * 4 + 2);
  expectTaxel(0, -kPitch, 0, 1 * 4 + 1);
  expectTaxel(0, 0, 0, 1 * 4 + 2);
  expectTaxel(-kPitch / 2, -kPitch, 0, 1 * 4 + 1);
  // The next smaller float belongs to the lower taxel.
  const double less = 1 - 0x1p-23;
  expectTaxel(kPitch / 2 * less, kPitch * less, 0, 1 * 4 + 2);
  expectTaxel(kPitch / 2, kPitch * less, 0, 2 * 4 + 2);
}

TEST_F(BordersOnEveryDriver, RimBelongsToTheArray) {
  expectTaxel(-1.5 * kPitch, -2 * kPitch, 0, 0);
  expectTaxel(1.5 * kPitch, 2 * kPitch, 0, 11);
  expectTaxel(1.5 * kPitch + kRimTolerance / 2, -2 * kPitch - kRimTolerance / 2, 0, 8);
  expectTaxel(1.5 * kPitch + 2 * kRimTolerance, 0, 0, -1);
  expectTaxel(0, -2 * kPitch - 2 * kRimTolerance, 0, -1);
}

TEST_F(BordersOnEveryDriver, AcceptsHeightsFromThicknessToBand) {
  expectTaxel(0, 0, 0x1p-13, 6);
  expectTaxel(0, 0, -0x1p-9, 6);
  expectTaxel(0, 0, 0x1p-13 * (1 + 0x1p-22), -1);
  expectTaxel(0, 0, -0x1p-9 * (1 + 0x1p-22), -1);
}

// 63 contacts on corners, edge midpoints and centres of cells: exactly one taxel takes each.
TEST_F(BordersOnEveryDriver, OneTaxelTakesEachContact) {
  Contacts contacts;
  for (int a = 0; a <= 6; ++a) {
    for (int b = 0; b <= 8; ++b) contacts.push_back({{(a - 3) * kPitch / 2, (b - 4) * kPitch / 2, 0}, 1});
  }
  const std::vector<double> forces = forcesOf(contacts);
  EXPECT_EQ(std::accumulate(forces.begin(), forces.end() - 1, 0.0), 63);
  EXPECT_EQ(forces.back(), 0);
  // Half-open: four in each cell, and two more along the rim that closes it.
  EXPECT_EQ(forces[0], 4);
  EXPECT_EQ(forces[3], 6);
  EXPECT_EQ(forces[8], 6);
  EXPECT_EQ(forces[11], 9);
}

}  // namespace
}  // namespace taxelsim
