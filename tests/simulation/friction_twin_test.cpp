// The device's shear against the twin's on random sensors, objects and paths, within bounds carried along each path.
//
// Sample by sample, beside the twin's traction q runs a bound e of what float32 may add. The cone is convex, so that a step keeps |q - q'|
// <= e but for what it adds itself: the stiffness times the displacement's rounding, the share of a step before touch where the depth is
// not sure, and mu times the pressure's width. Where it is not sure that, or which, object touched before, anything inside the cones is
// possible.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/vector3.h"
#include "reference/contact.h"
#include "reference/frame.h"
#include "reference/psf.h"
#include "reference/samples.h"
#include "simulation/comparison.h"
#include "support/curved_sensor.h"
#include "support/random_scene.h"

namespace taxelsim {
namespace {

using reference::PlacedObject;
using support::Bounded;
using support::Random;
using support::Touch;

constexpr double kObjectSize = 0.02;  // m
constexpr double kDt = 1e-3;          // s
constexpr int kNumSteps = 5;
// A displacement takes two rotations and a dozen products, in float32, of a turn by up to some angle over arms of up to kArm.
constexpr double kRelativeMotion = 32 * support::kUlp;
constexpr double kArm = 0.2;  // m
// With several objects a height loses its last bits to the slot's number: 2^-21 of at most the skin's thickness of 3 mm.
constexpr double kSlotRounding = 3e-3 * 0x1p-21;  // m
// Bounds wider than this, relative to the cone, would prove little; silhouettes and whispers may have them, half of a path's frames not.
constexpr double kLoosest = 0.1;
constexpr double kWhisper = 1e-2;  // N, of the cone

// What is known of one instance after a step.
struct Tracked {
  reference::FrictionState state;
  std::vector<double> error;        // (samples), Pa
  std::vector<double> cone;         // (samples), Pa: mu times the largest pressure
  std::vector<bool> touched;        // (samples): surely, and surely by the twin's object
  std::vector<bool> may_touch;      // (samples)
  std::vector<double> taxel_error;  // (num_taxels), N
  reference::Frame frame;
};

double angleOf(const Quaternion& from, const Quaternion& to) {
  const auto& [w, x, y, z] = from;
  const Quaternion turn = to * Quaternion{w, -x, -y, -z};
  return 2 * std::hypot(turn[1], turn[2], turn[3]);
}

// Whether, at each sample, it is sure which object is the one that touches: its surface is the lowest, or the first below the skin.
std::vector<bool> surelyLowest(const Sensor& sensor, const std::vector<PlacedObject>& placed, const support::Rounding& rounding) {
  std::vector<Bounded> heights;
  for (const PlacedObject& one : placed) heights.push_back(support::heightEnvelope(sensor, {&one, 1}, rounding.shift, rounding.margin_z));
  for (Bounded& of_one : heights) {
    for (double& height : of_one.low) height = std::max(height, -sensor.skin.thickness);
    for (double& height : of_one.high) height = std::max(height, -sensor.skin.thickness);
  }
  std::vector<bool> result(heights[0].low.size(), true);
  for (std::size_t n = 0; n < result.size(); ++n) {
    std::size_t lowest = 0;
    for (std::size_t k = 0; k < placed.size(); ++k) lowest = heights[k].high[n] < heights[lowest].high[n] ? k : lowest;
    for (std::size_t k = 0; k < placed.size(); ++k) {
      const bool both_below = k > lowest && heights[lowest].high[n] == -sensor.skin.thickness;
      if (k != lowest && !both_below && heights[k].low[n] <= heights[lowest].high[n]) result[n] = false;
    }
  }
  return result;
}

Tracked advance(const Sensor& sensor, const std::vector<PlacedObject>& placed, const support::Rounding& rounding, const Tracked& before) {
  const Friction& friction = sensor.skin.friction;
  const support::FrameEnvelope envelope = support::frameEnvelope(sensor, placed, rounding);
  const std::vector<bool> sure = surelyLowest(sensor, placed, rounding);
  const std::vector<reference::Sample> samples = reference::samplesOf(sensor);
  const bool is_first = before.state.objects.empty();
  Tracked now;
  now.frame = reference::simulateFrame(sensor, {.objects = placed, .previous_friction = before.state});
  now.state = now.frame.shear.state;
  now.error.assign(samples.size(), 0);
  now.cone = now.error;
  now.taxel_error.assign(now.frame.spread_force.size(), 0);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double d_low = envelope.penetration.low[n], d_high = envelope.penetration.high[n];
    const double p_low = reference::pressureOf(sensor.skin.law, d_low, 0), p_high = reference::pressureOf(sensor.skin.law, d_high, 0);
    now.touched.push_back(d_low > 0 && sure[n]);
    now.may_touch.push_back(d_high > 0);
    now.cone[n] = friction.friction_coefficient * p_high * (1 + rounding.relative_force);
    if (d_high <= 0 || is_first) continue;
    double error = 2 * now.cone[n];
    if (sure[n]) {
      const int number = std::max(now.state.touching[n], 0);
      const Pose &from = before.state.objects[number].X_SO, &to = placed[number].X_SO;
      const Pose& X_SP = sensor.patches[samples[n].patch].X_SP;
      const Vector3 p_S = X_SP * Vector3{samples[n].position_P[0], samples[n].position_P[1], -now.frame.penetration[n]};
      const Vector3 moved = subtract(to * (inverse(from) * p_S), p_S);
      const Vector3 u = rotate(inverse(X_SP).rotation, moved);
      const double angle = angleOf(from.rotation, to.rotation), along = std::hypot(u[0], u[1]);
      const double motion_error = kRelativeMotion * (length(u) + angle * kArm) + angle * rounding.margin_z;
      error = friction.tangential_stiffness * motion_error + friction.friction_coefficient * (p_high - p_low) +
              2 * rounding.relative_force * now.cone[n];
      if (before.touched[n]) {
        error += before.error[n];
      } else {
        // Of the step, after touch: depth / descent, at most 1.
        const auto share = [](double depth, double descent) { return descent > depth ? depth / descent : 1.0; };
        const double unsure = share(d_high, -u[2] - motion_error) - share(d_low, -u[2] + motion_error);
        error += friction.tangential_stiffness * along * unsure;
        if (before.may_touch[n]) error += before.cone[n] + friction.tangential_stiffness * along;
      }
      error = std::min(error, 2 * now.cone[n]);
    }
    now.error[n] = error;
    now.taxel_error[samples[n].taxel] += error * samples[n].area;
  }
  return now;
}

struct PathKind {
  support::SensorRange sensor;
  int curved = -1;  // instead: number of a curvedSensor(); 3: one grid with a spread along the skin
  double solid_share = 0.5;
  bool all_convex = false;
  int num_slots = 1;
  bool with_loads = false;
};

Sensor randomFrictionSensor(Random& random, const PathKind& kind) {
  Sensor sensor =
      kind.curved >= 0 && kind.curved < 3 ? support::curvedSensor(random, kind.curved) : support::randomSensor(random, kind.sensor);
  if (kind.curved == 3) sensor.psf = {.sigma = 0.7 * sensor.patches[0].pitch[0]};
  sensor.samples_per_taxel = random.integer(1, 5);
  const double stiffness = reference::pressureOf(sensor.skin.law, sensor.skin.thickness, 0) / sensor.skin.thickness;
  sensor.skin.friction = {stiffness * std::pow(10, random.uniform(-1.5, 1.5)), random.uniform(0.1, 1.5)};
  return sensor;
}

// The object rolls, slides, lifts a little or rests.
Pose nextPose(Random& random, const Pose& X_SO, double thickness) {
  if (random.chance(0.15)) return X_SO;
  const Vector3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1) + 1e-3};
  Pose next{X_SO.position, axisAngle(axis, random.uniform(0, 0.02)) * X_SO.rotation};
  for (double& coordinate : next.position) coordinate += random.uniform(-0.2, 0.2) * thickness;
  return next;
}

void runPath(const PathKind& kind, int seed) {
  Random random(static_cast<std::uint64_t>(seed));
  const Sensor sensor = randomFrictionSensor(random, kind);
  std::vector<Object> objects;
  for (int n = 0; n < 3; ++n) {
    objects.push_back(random.chance(kind.solid_share) ? support::randomSolid(random, kObjectSize)
                      : kind.all_convex               ? support::randomPolyhedron(random, kObjectSize)
                                                      : support::randomMeshObject(random, kObjectSize));
  }
  constexpr int kNumInstances = 2;
  std::vector<Touch> touches(kNumInstances);
  std::vector<float> loads;
  for (Touch& touch : touches) {
    for (int slot = 0; slot < kind.num_slots; ++slot) {
      touch.ids.push_back(random.integer(0, 2));
      touch.X_SO.push_back(isTaxelList(sensor) && !kind.with_loads
                               ? support::randomContactOnTaxel(random, sensor, objects[touch.ids.back()])
                               : support::randomContact(random, sensor, objects[touch.ids.back()]));
    }
    loads.push_back(kind.with_loads ? static_cast<float>(random.uniform(0.01, 0.5)) : kPoseDriven);
  }
  const int workgroups[] = {0, 4, 8, 16, 32, 64, 128, 256};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects, .contact_workgroup = workgroups[random.integer(0, 7)]});
  Simulator simulator(model, {.num_instances = kNumInstances, .num_slots = kind.num_slots});
  simulator.setLoads(loads);
  std::vector<Tracked> tracked(kNumInstances);
  std::vector<double> looseness;
  const std::size_t num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  for (int step = 0; step < kNumSteps; ++step) {
    support::setTouches(simulator, touches);
    simulator.step(kDt);
    const FrameView frame = simulator.read();
    support::expectWellFormed(frame, sensor, kNumInstances);
    for (int i = 0; i < kNumInstances; ++i) {
      SCOPED_TRACE("step " + std::to_string(step) + ", instance " + std::to_string(i));
      const auto placed = touches[i].placed(objects, frame.ground_truth.load_offset[i]);
      support::Rounding rounding = support::roundingFor(placed);
      // A pose that a load search moves is rounded once more.
      rounding.margin_z += (kind.num_slots > 1 ? kSlotRounding : 0) + (kind.with_loads ? support::kMarginZ : 0);
      tracked[i] = advance(sensor, placed, rounding, tracked[i]);
      const Tracked& twin = tracked[i];
      const std::vector<double> bound = reference::spread(sensor, twin.taxel_error);
      double width = 0, cone = 0;
      std::size_t num_wrong = 0;
      for (std::size_t t = 0; t < num_taxels; ++t) {
        const double slack = bound[t] + 200 * support::kUlp * sensor.skin.friction.friction_coefficient * twin.frame.spread_force[t] + 1e-9;
        for (std::size_t axis = 0; axis < 2; ++axis) {
          const double found = frame.ground_truth.tactile_shear_force[2 * (i * num_taxels + t) + axis];
          num_wrong += std::abs(found - twin.frame.spread_shear[t][axis]) <= slack ? 0 : 1;
        }
        width += twin.taxel_error[t];
        cone += sensor.skin.friction.friction_coefficient * twin.frame.contact.taxel_force[t];
      }
      EXPECT_EQ(num_wrong, 0u);
      if (cone > kWhisper) looseness.push_back(width / cone);
      // The wrench: shear at arms of up to the sensor's extent, beside the pressures within their own envelope.
      const support::FrameEnvelope envelope = support::frameEnvelope(sensor, placed, rounding);
      for (std::size_t axis = 0; axis < 6; ++axis) {
        const double arm = axis < 3 ? 1 : 0.1;  // m, where it is one
        const double slack = arm * (width + support::kRelativeMoment * (envelope.total_high + cone) + support::kAbsoluteForce) + 1e-9;
        const double found = frame.ground_truth.contact_wrench[6 * i + axis] - twin.frame.shear.wrench[axis];
        EXPECT_GE(found, envelope.wrench.low[axis] - slack) << "wrench[" << axis << "]";
        EXPECT_LE(found, envelope.wrench.high[axis] + slack) << "wrench[" << axis << "]";
      }
    }
    for (Touch& touch : touches) {
      for (Pose& X_SO : touch.X_SO) X_SO = nextPose(random, X_SO, sensor.skin.thickness);
    }
  }
  if (looseness.empty()) return;
  const auto middle = looseness.begin() + static_cast<std::ptrdiff_t>(looseness.size() / 2);
  std::nth_element(looseness.begin(), middle, looseness.end());
  EXPECT_LE(*middle, kLoosest);
}

class FrictionTwinSeeds : public ::testing::TestWithParam<int> {};

TEST_P(FrictionTwinSeeds, OneObject) {
  runPath({.sensor = {}}, GetParam());
}

TEST_P(FrictionTwinSeeds, Polyhedron) {
  runPath({.sensor = {}, .solid_share = 0, .all_convex = true}, 1000 + GetParam());
}

TEST_P(FrictionTwinSeeds, SeveralObjects) {
  runPath({.sensor = {}, .num_slots = 2 + GetParam() % 2}, 2000 + GetParam());
}

TEST_P(FrictionTwinSeeds, SeveralTiltedPatches) {
  runPath({.sensor = {.max_rows = 8, .max_cols = 8, .max_patches = 3, .max_patch_tilt = 0.5}, .num_slots = 1 + GetParam() % 2},
          3000 + GetParam());
}

TEST_P(FrictionTwinSeeds, UnderALoad) {
  runPath({.sensor = {.max_rows = 8, .max_cols = 8, .max_patches = 1 + GetParam() % 2, .max_patch_tilt = GetParam() % 4 < 2 ? 0.0 : 0.2},
           .with_loads = true},
          4000 + GetParam());
}

TEST_P(FrictionTwinSeeds, TaxelsWithPlacesOfTheirOwn) {
  runPath({.sensor = {}, .curved = GetParam() % 4, .num_slots = 1 + GetParam() / 4}, 5000 + GetParam());
}

TEST_P(FrictionTwinSeeds, TaxelsWithPlacesOfTheirOwnUnderALoad) {
  runPath({.sensor = {}, .curved = GetParam() % 4, .all_convex = true, .with_loads = true}, 6000 + GetParam());
}

INSTANTIATE_TEST_SUITE_P(Random, FrictionTwinSeeds, ::testing::Range(0, 8));

}  // namespace
}  // namespace taxelsim
