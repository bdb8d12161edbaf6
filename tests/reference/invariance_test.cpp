// Properties for any shape: monotone in depth, equivariant under translation and rotation of the grid, conservation of force.
#include "reference/frame.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::Frame;
using reference::simulateFrame;
using support::Random;

constexpr int kSide = 13;
constexpr double kPitch = 2e-3;  // m
// Relative: rounding of positions of 0.1 m in double, times the surface slopes at the samples.
constexpr double kRelative = 1e-7;
// N: below this a contact may consist of a sliver between samples, and is not compared.
constexpr double kMinForce = 1e-3;

Sensor squareSensor() {
  Sensor sensor = support::gridSensor({.num_rows = kSide, .num_cols = kSide, .pitch_x = kPitch, .pitch_y = kPitch, .samples_per_taxel = 3});
  sensor.psf = gaussianPsf(0.7, 5, Psf::Normalization::kNone);
  return sensor;
}

// An object in contact farther from the border than a taxel and half the kernel.
struct InnerContact {
  Object object;
  Pose X_SO;
};
InnerContact randomInnerContact(Random& random, const Sensor& sensor) {
  Object object = random.chance(0.5) ? support::randomMeshObject(random, 3e-3) : Object(Sphere{random.uniform(1e-3, 2e-3)});
  const Quaternion R_SO = random.rotation();
  const Pose X_SO =
      support::poseAtDepth(sensor, object, R_SO, random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3), random.uniform(1e-4, 1e-3));
  return {std::move(object), X_SO};
}

RC_GTEST_PROP(Invariance, TranslationByWholeTaxelsTranslatesTheImage, (std::uint32_t seed)) {
  Random random(seed);
  const Sensor sensor = squareSensor();
  const InnerContact contact = randomInnerContact(random, sensor);
  Pose moved = contact.X_SO;
  moved.position[0] += kPitch;
  moved.position[1] -= 2 * kPitch;
  const Frame a = simulateFrame(sensor, {.objects = {{&contact.object, contact.X_SO}}});
  const Frame b = simulateFrame(sensor, {.objects = {{&contact.object, moved}}});
  RC_PRE(a.clean.total_force > kMinForce);
  for (int i = 0; i + 1 < kSide; ++i) {
    for (int j = 2; j < kSide; ++j) {
      RC_ASSERT(std::abs(a.spread_force[i * kSide + j] - b.spread_force[(i + 1) * kSide + j - 2]) <= kRelative * a.clean.total_force);
    }
  }
  RC_ASSERT(std::abs(b.clean.center_of_pressure[0] - a.clean.center_of_pressure[0] - kPitch) <= kRelative);
}

RC_GTEST_PROP(Invariance, QuarterTurnRotatesImageAndEdgeAngle, (std::uint32_t seed)) {
  Random random(seed);
  const Sensor sensor = squareSensor();
  const InnerContact contact = randomInnerContact(random, sensor);
  const Pose turned = Pose{{0, 0, 0}, axisAngle({0, 0, 1}, std::numbers::pi / 2)} * contact.X_SO;
  const Frame a = simulateFrame(sensor, {.objects = {{&contact.object, contact.X_SO}}});
  const Frame b = simulateFrame(sensor, {.objects = {{&contact.object, turned}}});
  RC_PRE(a.clean.total_force > kMinForce);
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      // (x, y) -> (-y, x).
      RC_ASSERT(std::abs(a.spread_force[i * kSide + j] - b.spread_force[(kSide - 1 - j) * kSide + i]) <= kRelative * a.clean.total_force);
    }
  }
  if (a.clean.edge_confidence > 0.05) {
    const double turn = std::remainder(b.clean.edge_angle - a.clean.edge_angle - std::numbers::pi / 2, std::numbers::pi);
    RC_ASSERT(std::abs(turn) <= 100 * kRelative);
  }
}

RC_GTEST_PROP(Invariance, ForceGrowsWithDepth, (std::uint32_t seed)) {
  Random random(seed);
  const Sensor sensor = support::randomSensor(random);
  const Object object = random.chance(0.5) ? support::randomMeshObject(random, 0.02) : support::randomSolid(random, 0.02);
  Pose X_SO = support::randomContact(random, sensor, object);
  const Frame shallow = simulateFrame(sensor, {.objects = {{&object, X_SO}}});
  X_SO.position[2] -= random.uniform(0, 1e-3);
  const Frame deep = simulateFrame(sensor, {.objects = {{&object, X_SO}}});
  for (std::size_t t = 0; t < shallow.spread_force.size(); ++t) {
    // Sample positions in O are rounded differently after the move.
    RC_ASSERT(deep.contact.taxel_force[t] >= shallow.contact.taxel_force[t] * (1 - 1e-9) - 1e-12);
  }
}

RC_GTEST_PROP(Invariance, WrenchIsConsistentWithTotalForce, (std::uint32_t seed)) {
  Random random(seed);
  const Sensor sensor = support::randomSensor(random);
  const Object object = support::randomMeshObject(random, 0.02);
  const Frame frame = simulateFrame(sensor, {.objects = {{&object, support::randomContact(random, sensor, object)}}});
  const double force = frame.contact.total_force;
  RC_ASSERT(std::abs(frame.contact.wrench[2] + force) <= 1e-12 * (1 + force));
  RC_ASSERT(frame.contact.wrench[5] == 0.0);
  if (sensor.psf.normalization == Psf::Normalization::kPerSource) {
    RC_ASSERT(std::abs(frame.clean.total_force - force) <= 1e-12 * (1 + force));
  }
}

RC_GTEST_PROP(Invariance, ImageIsInvariantUnderPatchPose, (std::uint32_t seed)) {
  // Patch and object move together.
  Random random(seed);
  Sensor sensor = squareSensor();
  const InnerContact contact = randomInnerContact(random, sensor);
  const Frame a = simulateFrame(sensor, {.objects = {{&contact.object, contact.X_SO}}});
  RC_PRE(a.clean.total_force > kMinForce);
  const Pose X_SP{{0.02, -0.01, 0.03}, random.rotation()};
  sensor.patches[0].X_SP = X_SP;
  const Frame b = simulateFrame(sensor, {.objects = {{&contact.object, X_SP * contact.X_SO}}});
  for (std::size_t t = 0; t < a.spread_force.size(); ++t) {
    RC_ASSERT(std::abs(a.spread_force[t] - b.spread_force[t]) <= kRelative * a.clean.total_force);
  }
  const Vector3 expected = X_SP * a.clean.center_of_pressure;
  for (int axis = 0; axis < 3; ++axis) {
    RC_ASSERT(std::abs(b.clean.center_of_pressure[axis] - expected[axis]) <= kRelative);
  }
}

}  // namespace
}  // namespace taxelsim
