// The device against closed forms of the Winkler foundation, without the twin.
#include "simulation/comparison.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kStiffness = 1.73e8;  // N/m^3
// Depth is rounded by kMarginZ at most; the mean depth of the contacts below is at least this.
constexpr double kMeanDepth = 0.2e-3;  // m
constexpr double kFloatError = support::kMarginZ / kMeanDepth;

struct Result {
  double total_force, wrench_z, centre_x, centre_y;
};

Result run(const Sensor& sensor, const Object& object, const Pose& X_SO) {
  Simulator simulator = support::makeSimulator(sensor, {object});
  const FrameView frame = support::stepOnce(simulator, {{{0}, {X_SO}}}, 1e-3);
  return {frame.ground_truth.total_force[0], frame.ground_truth.contact_wrench[2], frame.ground_truth.center_of_pressure[0],
          frame.ground_truth.center_of_pressure[1]};
}

// Taxels of 1 mm.
Sensor squareSensor(int taxels_per_side, int samples_per_taxel) {
  return support::gridSensor({.num_rows = taxels_per_side,
                              .num_cols = taxels_per_side,
                              .pitch_x = 1e-3,
                              .pitch_y = 1e-3,
                              .samples_per_taxel = samples_per_taxel,
                              .thickness = 2e-3});
}

// 20 x 20 taxels, 8 x 8 samples each.
Sensor fineSensor() {
  return squareSensor(20, 8);
}

void expectForce(const Result& result, double expected, double discretisation) {
  EXPECT_NEAR(result.total_force / expected, 1, discretisation + kFloatError);
  EXPECT_NEAR(result.wrench_z / expected, -1, discretisation + kFloatError);
}

TEST(ClosedFormsOnEveryDriver, SphereExact) {
  const double R = 12e-3, depth = 0.9e-3;  // contact radius 4.56 mm: 36 samples
  // 0.15 % at 8 samples per radius (worst over offsets, by an independent program), falling further.
  expectForce(run(fineSensor(), Object(Sphere{R}), {.position = {0.13e-3, -0.29e-3, R - depth}}),
              kPi * kStiffness * depth * depth * (R - depth / 3), 0.0015);
}

TEST(ClosedFormsOnEveryDriver, CylinderExact) {
  const double R = 5e-3, depth = 0.5e-3, length = 12e-3, half_width = std::sqrt(2 * R * depth - depth * depth);
  const double section = R * R * std::acos((R - depth) / R) - (R - depth) * half_width;
  const double samples_per_half_width = half_width / (1e-3 / 8);
  // 12 mm is 96 samples: no error along the axis at an offset that leaves its ends between samples.
  expectForce(run(fineSensor(), Object(Cylinder{R, length}), {{0.05e-3, 0.02e-3, R - depth}, axisAngle({1, 0, 0}, kPi / 2)}),
              kStiffness * length * section, 0.275 / (samples_per_half_width * samples_per_half_width));
}

TEST(ClosedFormsOnEveryDriver, FlatPunch) {
  const double side_x = 5e-3, side_y = 8e-3, depth = 0.7e-3;  // 40 x 64 samples
  const Object solid(Box{{side_x, side_y, 10e-3}}), mesh("box", support::boxMesh({side_x, side_y, 10e-3}));
  for (const Object* object : {&solid, &mesh}) {
    const Result result = run(fineSensor(), *object, {.position = {1.0e-3 + 0.02e-3, -2.0e-3 + 0.02e-3, 5e-3 - depth}});
    expectForce(result, kStiffness * side_x * side_y * depth, 0);
  }
  // A punch that covers 4 x 8 whole taxels: the centre of pressure is its own.
  const Result result = run(fineSensor(), Object(Box{{4e-3, 8e-3, 10e-3}}), {.position = {2e-3, -1e-3, 5e-3 - depth}});
  EXPECT_NEAR(result.centre_x, 2e-3, 1e-2 * kFloatError);
  EXPECT_NEAR(result.centre_y, -1e-3, 1e-2 * kFloatError);
}

// 160 x 160 samples on 10 x 10 taxels: the same numbers of samples as above on half the lengths. One taxel, too: its samples fit a tile.
TEST(ClosedFormsOnEveryDriver, MostSamples) {
  const double R = 6e-3, depth = 0.45e-3;
  expectForce(run(squareSensor(10, kMaxSamplesPerTaxel), Object(Sphere{R}), {.position = {0.065e-3, -0.145e-3, R - depth}}),
              kPi * kStiffness * depth * depth * (R - depth / 3), 0.0015);
  const double side_x = 0.5e-3, side_y = 0.75e-3;  // 8 x 12 samples
  expectForce(
      run(squareSensor(1, kMaxSamplesPerTaxel), Object(Box{{side_x, side_y, 10e-3}}), {.position = {0.01e-3, 0.01e-3, 5e-3 - depth}}),
      kStiffness * side_x * side_y * depth, 0);
}

TEST(ClosedFormsOnEveryDriver, Cone) {
  const Cone cone{.radius = 8e-3, .height = 4e-3};
  const double depth = 1.2e-3, slope = 0.5, samples_per_radius = depth / slope / (1e-3 / 8);
  expectForce(run(fineSensor(), Object(cone), {.position = {0.03e-3, 0.05e-3, -depth}}),
              kPi * kStiffness * depth * depth * depth / (3 * slope * slope), 1 / (samples_per_radius * samples_per_radius));
}

TEST(ClosedFormsOnEveryDriver, TiltedHalfSpace) {
  const double phi = 0.04, depth = 0.8e-3, side = 20e-3;
  const Sensor sensor = fineSensor();
  Simulator simulator = support::makeSimulator(sensor, {Object(HalfSpace{})});
  const FrameView frame = support::stepOnce(simulator, {{{0}, {{{0, 0, -depth}, axisAngle({0, 1, 0}, phi)}}}}, 1e-3);
  EXPECT_NEAR(frame.ground_truth.total_force[0] / (kStiffness * side * side * depth), 1, kFloatError);
  // M = k tan(phi) b a^3 / 12, less 1/160^2 for the midpoint rule.
  const double moment = kStiffness * std::tan(phi) * side * side * side * side / 12 * (1 - 1.0 / (160 * 160));
  EXPECT_NEAR(frame.ground_truth.contact_wrench[4] / moment, 1, 10 * kFloatError);
}

}  // namespace
}  // namespace taxelsim
