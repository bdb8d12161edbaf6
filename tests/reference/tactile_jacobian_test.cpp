// Tactile Jacobian of the reference against closed forms and against central differences of the features.
#include "reference/tactile_jacobian.h"
#include "base/vector3.h"
#include "support/contact_cases.h"
#include "support/jacobian_cases.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::ByTwist;
using reference::FeatureJacobian;
using reference::Frame;
using reference::PlacedObject;
using reference::TactileJacobian;
using support::JacobianCase;
using support::JacobianChanges;
using support::JacobianErrors;
using support::JacobianKind;
using support::Random;

constexpr double kStiffness = 1e8;  // N/m^3
constexpr double kRounding = 1e-9;

// Coordinates of the twist.
enum By { kVx, kVy, kVz, kWx, kWy, kWz };

struct Pressed {
  Frame frame;
  TactileJacobian jacobian;
};

Pressed press(const Sensor& sensor, const Object& object, const Pose& X_SO) {
  const PlacedObject placed{&object, X_SO};
  Frame frame = reference::simulateFrame(sensor, {.objects = {placed}});
  TactileJacobian jacobian = reference::tactileJacobian(sensor, frame);
  return {std::move(frame), std::move(jacobian)};
}

Sensor fineGrid(double pitch, int side, int samples) {
  return support::gridSensor({.num_rows = side,
                              .num_cols = side,
                              .pitch_x = pitch,
                              .pitch_y = pitch,
                              .samples_per_taxel = samples,
                              .thickness = 5e-3,
                              .law = {kStiffness, 1, 0}});
}

void expectRow(const reference::ByTwist& found, const std::array<double, 6>& expected, double slack) {
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(found[k], expected[k], slack) << k;
}

// A level face over the whole array: dF/dz = stiffness times area; a rotation shifts the pressure to one side.
TEST(TactileJacobian, FaceOverTheWholeArrayMatchesClosedForm) {
  constexpr double kDepth = 1e-3, kPitchX = 2e-3, kPitchY = 3e-3, kRows = 7, kCols = 5;
  for (const int samples : {1, 2, 4, 8}) {
    const Sensor sensor = support::gridSensor({.num_rows = 7,
                                               .num_cols = 5,
                                               .pitch_x = kPitchX,
                                               .pitch_y = kPitchY,
                                               .samples_per_taxel = samples,
                                               .thickness = 3e-3,
                                               .law = {kStiffness, 1, 0}});
    const auto [frame, jacobian] = press(sensor, Object(HalfSpace{}), {{0, 0, -kDepth}});
    const double area = kRows * kCols * kPitchX * kPitchY;
    // Second moments of the taxel centres: the image does not resolve positions within a taxel.
    const double xx = kPitchX * kPitchX * (kRows * kRows - 1) / 12, yy = kPitchY * kPitchY * (kCols * kCols - 1) / 12;
    expectRow(jacobian.clean.total_force_by_twist, {0, 0, kStiffness * area, 0, 0, 0}, kRounding * kStiffness * area);
    expectRow(jacobian.clean.center_of_pressure[0], {0, 0, 0, 0, -xx / kDepth, 0}, kRounding);
    expectRow(jacobian.clean.center_of_pressure[1], {0, 0, 0, yy / kDepth, 0, 0}, kRounding);
    expectRow(jacobian.clean.center_of_pressure[2], {0, 0, 0, 0, 0, 0}, 0);
    // The wrench resolves the samples.
    const double wrench_xx = kPitchX * kPitchX * (kRows * kRows - 1.0 / (samples * samples)) / 12;
    EXPECT_NEAR(jacobian.contact_wrench[4][kWy], -kStiffness * area * wrench_xx, kRounding * kStiffness * area);
    EXPECT_NEAR(jacobian.contact_wrench[2][kVz], -kStiffness * area, kRounding * kStiffness * area);
  }
}

// Vertical walls: the force moves with the box, which a sum of f' d_t over samples would miss. A box three taxels wide covers the same
// number of taxel sides at every position.
TEST(TactileJacobian, PunchWithVerticalWallsMovesWithTheObject) {
  constexpr double kPitch = 3.4e-3, kDepth = 0.8e-3;
  Random random(1);
  for (int draw = 0; draw < 50; ++draw) {
    const Sensor sensor = fineGrid(kPitch, 8, random.integer(1, 8));
    const double x = random.uniform(-4e-3, 4e-3), y = random.uniform(-4e-3, 4e-3), side = 1.5 * kPitch;
    const auto [frame, jacobian] = press(sensor, Object(Box{{2 * side, 2 * side, 10e-3}}), {{x, y, 5e-3 - kDepth}});
    const auto& center = frame.clean.center_of_pressure;
    const double area = 4 * side * side;
    expectRow(jacobian.clean.total_force_by_twist,
              {0, 0, kStiffness * area, kStiffness * area * center[1], -kStiffness * area * center[0], 0}, 1e-9 * kStiffness * area);
    // The box is fixed in the world, so in S its contact moves opposite to the sensor.
    EXPECT_NEAR(jacobian.clean.center_of_pressure[0][kVx], -1, 1e-9);
    EXPECT_NEAR(jacobian.clean.center_of_pressure[0][kVy], 0, 1e-9);
    EXPECT_NEAR(jacobian.clean.center_of_pressure[0][kVz], 0, 1e-9);
    EXPECT_NEAR(jacobian.clean.center_of_pressure[1][kVy], -1, 1e-9);
    EXPECT_NEAR(jacobian.clean.center_of_pressure[0][kWz], center[1], 1e-9);
    EXPECT_NEAR(jacobian.clean.center_of_pressure[1][kWz], -center[0], 1e-9);
  }
}

// A sphere is invariant under rotation about its centre, so all columns follow from the motion of the centre.
TEST(TactileJacobian, SphereMatchesClosedForm) {
  constexpr double kRadius = 10e-3, kDepth = 0.8e-3;
  // Contact radius 4 mm: 4 taxels, about 30 samples. The discretisation error of the centre falls with the fourth power.
  constexpr double kSlack = 0.01;
  const Vector3 middle{1.3e-3, -2.1e-3, kRadius - kDepth};
  const Sensor sensor = fineGrid(1e-3, 20, 8);
  const auto [frame, jacobian] = press(sensor, Object(Sphere{kRadius}), {middle});
  const double area = std::numbers::pi * (2 * kRadius * kDepth - kDepth * kDepth), by_z = kStiffness * area;
  const ByTwist& force = jacobian.clean.total_force_by_twist;
  const std::array<ByTwist, 3>& center = jacobian.clean.center_of_pressure;
  EXPECT_NEAR(force[kVz], by_z, kSlack * by_z);
  EXPECT_NEAR(force[kWx], by_z * middle[1], kSlack * by_z * kRadius);
  EXPECT_NEAR(force[kWy], -by_z * middle[0], kSlack * by_z * kRadius);
  for (const By by : {kVx, kVy, kWz}) EXPECT_NEAR(force[by], 0, kSlack * by_z * (by == kWz ? kRadius : 1));
  for (std::size_t k = 0; k < 6; ++k) {
    const double slack = kSlack * (k < 3 ? 1 : kRadius);
    EXPECT_NEAR(center[0][k], (std::array<double, 6>{-1, 0, 0, 0, -middle[2], middle[1]})[k], slack) << k;
    EXPECT_NEAR(center[1][k], (std::array<double, 6>{0, -1, 0, middle[2], 0, -middle[0]})[k], slack) << k;
  }
}

// Cone with the tip down: F = pi k depth^3 / (3 tan^2 flank).
TEST(TactileJacobian, ConeMatchesClosedForm) {
  constexpr double kRadius = 8e-3, kHeight = 4e-3, kDepth = 1.5e-3, kSlack = 0.005;
  const Sensor sensor = fineGrid(1e-3, 16, 8);
  const Object cone(Cone{kRadius, kHeight});
  const auto [frame, jacobian] = press(sensor, cone, {{0.3e-3, 0.2e-3, -kDepth}});
  const double by_z = std::numbers::pi * kStiffness * kDepth * kDepth * kRadius * kRadius / (kHeight * kHeight);
  EXPECT_NEAR(frame.clean.total_force, by_z * kDepth / 3, kSlack * by_z * kDepth / 3);
  EXPECT_NEAR(jacobian.clean.total_force_by_twist[kVz], by_z, kSlack * by_z);
  EXPECT_NEAR(jacobian.clean.center_of_pressure[0][kVx], -1, kSlack);
}

// Without contact all derivatives are 0; for a round image that of the edge angle is.
TEST(TactileJacobian, UndefinedDerivativesAreZero) {
  const Sensor sensor = fineGrid(2e-3, 4, 4);
  const TactileJacobian nothing = press(sensor, Object(Sphere{5e-3}), {{0, 0, 6e-3}}).jacobian;
  for (const auto& row : nothing.clean.center_of_pressure) expectRow(row, {}, 0);
  expectRow(nothing.clean.total_force_by_twist, {}, 0);
  const TactileJacobian round = press(sensor, Object(Sphere{5e-3}), {{0, 0, 4.5e-3}}).jacobian;
  expectRow(round.clean.edge_angle, {}, 0);
  EXPECT_GT(round.clean.total_force_by_twist[kVz], 0);
}

// Against central differences of the features. Tolerances, relative, at 4 x 4 and 8 x 8 samples per taxel.

constexpr double kFourSamples = 0.05, kEightSamples = 0.02;
// Vertical walls are located to half the sample spacing. A wall along a taxel side of 3 mm, in a contact of 8 to 14 mm, affects half of the
// flux through that side at 4 x 4: at most 3 / 8 / 2 of the centre's motion. Randomly rotated walls follow a side for a short length only.
constexpr double kWalls = 0.12;

support::FeatureChanges changesOf(const FeatureJacobian& row) {
  return {row.center_of_pressure, row.total_force_by_twist, row.edge_angle};
}

support::JacobianScale scaleOf(const FeatureJacobian& row, bool several_contacts = false) {
  const double size = std::sqrt(row.trace);
  return {size, length(row.features.center_of_pressure), row.features.edge_confidence, several_contacts ? size : 0,
          row.features.total_force};
}

// At 4 x 4 and 8 x 8 samples.
struct Errors {
  JacobianErrors four, eight;
};

Errors errorsOf(JacobianKind kind, int num_contacts) {
  Random random(7);
  Errors errors;
  int num_measured = 0;
  for (int draw = 0; draw < num_contacts; ++draw) {
    JacobianCase contact = support::randomJacobianCase(random, kind);
    const JacobianChanges expected = support::centralDifferences(contact);
    for (const int samples : {4, 8}) {
      JacobianErrors& error = samples == 4 ? errors.four : errors.eight;
      contact.sensor.samples_per_taxel = samples;
      const Frame frame = reference::simulateFrame(contact.sensor, {.objects = contact.placed()});
      const TactileJacobian found = reference::tactileJacobian(contact.sensor, frame);
      error.add(changesOf(found.clean), expected.sensor, scaleOf(found.clean, found.clean_patches.size() > 1));
      if (!contact.has_walls && expected.triggers_hold &&
          support::reportingTaxels(contact.sensor, frame.spread_force) == expected.reports) {
        ++num_measured;
        error.add(changesOf(found.measured), expected.measured, scaleOf(found.measured, found.clean_patches.size() > 1));
      }
      error.addWrench(found.contact_wrench, expected.contact_wrench, scaleOf(found.clean));
      for (std::size_t p = 0; p < found.clean_patches.size(); ++p) {
        error.add(changesOf(found.clean_patches[p]), expected.patches[p], scaleOf(found.clean_patches[p]));
      }
    }
  }
  if (kind != JacobianKind::kWalls) {
    EXPECT_GT(num_measured, num_contacts / 3);
  }
  errors.four.print("4 x 4");
  errors.eight.print("8 x 8");
  return errors;
}

TEST(TactileJacobianDifferences, MatchOnRoundSolids) {
  const Errors errors = errorsOf(JacobianKind::kRound, 20);
  EXPECT_LT(errors.four.worst(), kFourSamples);
  EXPECT_LT(errors.four.worstAngle(), kFourSamples);
  EXPECT_LT(errors.eight.worst(), kEightSamples);
  EXPECT_LT(errors.eight.worstAngle(), kEightSamples);
}

TEST(TactileJacobianDifferences, MatchOnSeveralPatches) {
  const Errors errors = errorsOf(JacobianKind::kPatches, 10);
  EXPECT_LT(errors.four.worst(), kFourSamples);
  EXPECT_LT(errors.four.worstAngle(), kFourSamples);
  EXPECT_LT(errors.eight.worst(), kEightSamples);
  EXPECT_LT(errors.eight.worstAngle(), kEightSamples);
}

TEST(TactileJacobianDifferences, MatchOnVerticalWalls) {
  const Errors errors = errorsOf(JacobianKind::kWalls, 20);
  EXPECT_LT(errors.four.worst(), kWalls);
  EXPECT_LT(errors.four.worstAngle(), kWalls);
  EXPECT_LT(errors.eight.worst(), kWalls);
  EXPECT_LT(errors.eight.worstAngle(), kWalls);
}

}  // namespace
}  // namespace taxelsim
