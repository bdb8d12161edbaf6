// The device's shear against the twin's on random sensors, objects and paths, within bounds that are updated along each path.
//
// Each sample has a bound e of the float32 error of the twin's traction q. The friction cone is convex, so a step keeps |q - q'| <= e
// except for the error of the step itself: the stiffness times the rounding of the displacement, the unsure share of a step before touch,
// and mu times the width of the pressure. Where it is unsure whether, or which, object touched before, any traction inside the cones is
// allowed. For the law lugre e bounds the bend of a bristle, in units of friction.
#include "base/vector3.h"
#include "reference/contact.h"
#include "reference/frame.h"
#include "reference/psf.h"
#include "reference/samples.h"
#include "simulation/comparison.h"
#include "support/cases.h"
#include "support/curved_sensor.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::PlacedObject;
using support::Bounded;
using support::Random;
using support::Touch;

constexpr double kObjectSize = 0.02;  // m
constexpr int kNumObjects = 3;
constexpr int kNumSteps = 5;
// A displacement takes two rotations and a dozen float32 products, with an angle over arms of up to kArm.
constexpr double kRelativeMotion = 32 * support::kUlp;
constexpr double kArm = 0.2;  // m
// With several slots a height loses its last bits to the slot number: 2^-21 of the thickness of the skin, at most 3 mm.
constexpr double kSlotRounding = 3e-3 * 0x1p-21;  // m
// The median width of the bounds, relative to the cone, where the cone is at least kWhisper (N).
constexpr double kLoosest = 0.1, kWhisper = 1e-2;
// A dozen operations of a bristle step, among them exp() with an error of 3 + 2 |x| ulp.
constexpr double kBristleRounding = 32 * support::kUlp;

// State of one instance after a step, with bounds.
struct Tracked {
  reference::FrictionState state;
  std::vector<double> error;        // (samples), of what the state holds: Pa; bristles: of the pressure
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

// Whether it is certain which object touches each sample: its surface is the lowest, or the first one below the skin.
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

// Inputs of bristleError().
struct BristleStep {
  reference::Shear bend, u;     // before the step, m; m
  double share, dt;             // of u after touch; s
  double bend_error;            // before the step, of the pressure
  double motion_error, unsure;  // m; of `share`
};

// Bounds of bend and shear after the step, relative to the pressure.
struct BristleError {
  double bend, shear;
};

// s <- g a + (s - g a) e^-x with a = u / |u| and x = sigma_0 |u| / g: adds the errors of s, a, g and x, then those of the rates.
BristleError bristleError(const LuGre& law, const BristleStep& step) {
  const double stiffness = law.bristle_stiffness, most = law.static_friction;
  const double way = std::hypot(step.u[0], step.u[1]), speed = way / step.dt;
  if (way + step.motion_error == 0) return {step.bend_error, step.bend_error};
  const double g = reference::stribeckFriction(law, speed), off = g + most;
  const double speed_error = step.motion_error / step.dt + kBristleRounding * speed;
  // |d exp(-r^2) / dr| <= sqrt(2 / e).
  const double g_error =
      (law.static_friction - law.coulomb_friction) * std::min(1.0, std::sqrt(2 / std::exp(1.0)) * speed_error / law.stribeck_velocity) +
      kBristleRounding * g;
  const double g_low = std::max(law.coulomb_friction * (1 - kBristleRounding), g - g_error);
  const double x = stiffness * way * step.share / g;
  const double x_error =
      stiffness * (step.share * step.motion_error + way * step.unsure) / g_low + x * (g_error / g_low + kBristleRounding);
  const double fade = std::exp(-std::max(0.0, x - x_error));
  const double turned = way > 0 ? std::min(2.0, 2 * step.motion_error / way) : 2;
  BristleError error{};
  error.bend = std::min(step.bend_error * fade + g * std::min(1.0, x + x_error) * turned + g_error + off * std::min(1.0, x_error * fade) +
                            kBristleRounding * off,
                        2 * most);
  const double factor = law.bristle_damping * (speed + speed_error) / g_low * fade;
  const double factor_error =
      law.bristle_damping * fade / g_low * (speed_error + speed * (std::min(1.0, x_error) + g_error / g)) + kBristleRounding * factor;
  const double unbounded = error.bend + factor * (step.bend_error + g * turned + g_error + kBristleRounding * off) + factor_error * off +
                           law.viscous_friction * (speed_error + speed * turned);
  // Projection onto the cone reduces the error in the same proportion; the twin's unprojected sum is used.
  reference::Shear sum{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double along = way > 0 ? step.u[axis] / way : 0, left = (g * along - stiffness * step.bend[axis]) * std::exp(-x);
    sum[axis] = g * along - left + law.bristle_damping * speed / g * left + law.viscous_friction * speed * along;
  }
  const double shortest = std::hypot(sum[0], sum[1]) - unbounded;
  error.shear = std::min(shortest > most ? unbounded * most / shortest : unbounded, 2 * most) + kBristleRounding * most;
  return error;
}

// Friction coefficient of the cone.
double coneOf(const Sensor& sensor) {
  const LuGre* bristles = std::get_if<LuGre>(&sensor.skin.law);
  return bristles != nullptr ? bristles->static_friction : sensor.skin.friction.friction_coefficient;
}

Tracked advance(const Sensor& sensor, const std::vector<PlacedObject>& placed, const support::Rounding& rounding, const Tracked& before,
                double dt, double slot_rounding) {
  const Friction& friction = sensor.skin.friction;
  const LuGre* bristles = std::get_if<LuGre>(&sensor.skin.law);
  const double mu = coneOf(sensor);
  const support::FrameEnvelope envelope = support::frameEnvelope(sensor, placed, rounding);
  const std::vector<bool> sure = surelyLowest(sensor, placed, rounding);
  const std::vector<reference::Sample> samples = reference::samplesOf(sensor);
  const bool is_first = before.state.objects.empty();
  Tracked now;
  now.frame = reference::simulateFrame(sensor, {.objects = placed, .previous_friction = before.state, .dt = dt});
  now.state = now.frame.shear.state;
  now.error.assign(samples.size(), 0);
  now.cone = now.error;
  now.taxel_error.assign(now.frame.spread_force.size(), 0);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double d_low = envelope.penetration.low[n], d_high = envelope.penetration.high[n];
    const double p_low = reference::contactPressure(sensor.skin.law, d_low, 0),
                 p_high = reference::contactPressure(sensor.skin.law, d_high, 0);
    now.touched.push_back(d_low > 0 && sure[n]);
    now.may_touch.push_back(d_high > 0);
    now.cone[n] = mu * p_high * (1 + rounding.relative_force);
    if (d_high <= 0 || is_first) continue;
    double error = 2 * now.cone[n], bend_error = 2 * mu;
    if (sure[n]) {
      const int number = std::max(now.state.touching[n], 0);
      const Pose &from = before.state.objects[number].X_SO, &to = placed[number].X_SO;
      const Pose& X_SP = sensor.patches[samples[n].patch].X_SP;
      const Vector3 p_S = X_SP * Vector3{samples[n].position_P[0], samples[n].position_P[1], -now.frame.penetration[n]};
      const Vector3 moved = subtract(to * (inverse(from) * p_S), p_S);
      const Vector3 u = rotate(inverse(X_SP).rotation, moved);
      const double angle = angleOf(from.rotation, to.rotation), along = std::hypot(u[0], u[1]);
      const double motion_error = kRelativeMotion * (length(u) + angle * kArm) + angle * rounding.margin_z;
      // Share of the step after touch: depth / descent, at most 1.
      const auto share = [](double depth, double descent) { return descent > depth ? depth / descent : 1.0; };
      const double unsure = share(d_high, -u[2] - motion_error) - share(d_low, -u[2] + motion_error);
      error = mu * (p_high - p_low) + 2 * rounding.relative_force * now.cone[n];
      const bool is_held = before.touched[n] && before.state.touching[n] == number;
      if (bristles != nullptr && (is_held || !before.may_touch[n] || before.touched[n])) {
        const BristleError step = bristleError(*bristles, {.bend = is_held ? before.state.history[n] : reference::Shear{0, 0},
                                                           .u = {u[0], u[1]},
                                                           .share = is_held ? 1 : share(now.frame.penetration[n], -u[2]),
                                                           .dt = dt,
                                                           .bend_error = is_held ? before.error[n] : 0,
                                                           .motion_error = motion_error,
                                                           .unsure = is_held ? 0 : unsure});
        bend_error = step.bend + slot_rounding * mu;
        error += step.shear * p_high;
      } else if (bristles != nullptr) {
        error += 2 * now.cone[n];
      } else if (before.touched[n]) {
        error += friction.tangential_stiffness * motion_error + before.error[n];
      } else {
        error += friction.tangential_stiffness * (motion_error + along * unsure);
        if (before.may_touch[n]) error += before.cone[n] + friction.tangential_stiffness * along;
      }
      error = std::min(error, 2 * now.cone[n]);
    }
    now.error[n] = bristles != nullptr ? bend_error : error;
    now.taxel_error[samples[n].taxel] += error * samples[n].area;
  }
  return now;
}

enum class Shears { kSprings, kBristles, kAnyBristles };

struct PathKind {
  support::SensorRange sensor;
  int curved = -1;  // instead: number of a curvedSensor(); 3: one grid with a spread along the skin
  Shears shears = Shears::kSprings;
  double solid_share = 0.5;
  bool all_convex = false;
  int num_slots = 1;
  bool with_loads = false;
};

// Parameters near the preset, or each up to six orders of magnitude off.
LuGre randomLuGre(Random& random, double stiffness, bool any) {
  const auto around = [&](double value, double decades) { return value * std::pow(10, random.uniform(-decades, decades)); };
  const double decades = any ? 6 : 0.3;
  LuGre law{stiffness, around(1e5, decades), around(316.2, decades), around(0.4, decades), 0, 0, around(1e-3, decades)};
  law.coulomb_friction = any ? std::pow(10, random.uniform(-6, 2.5)) : random.uniform(0.1, 1.5);
  law.static_friction = law.coulomb_friction * random.uniform(1, 3);
  return law;
}

Sensor randomFrictionSensor(Random& random, const PathKind& kind) {
  Sensor sensor =
      kind.curved >= 0 && kind.curved < 3 ? support::curvedSensor(random, kind.curved) : support::randomSensor(random, kind.sensor);
  if (kind.curved == 3) sensor.psf = {.sigma = 0.7 * sensor.patches[0].pitch[0]};
  sensor.samples_per_taxel = random.integer(1, 5);
  const double stiffness = reference::contactPressure(sensor.skin.law, sensor.skin.thickness, 0) / sensor.skin.thickness;
  if (kind.shears == Shears::kSprings) {
    sensor.skin.friction = {stiffness * std::pow(10, random.uniform(-1.5, 1.5)), random.uniform(0.1, 1.5)};
  } else {
    sensor.skin.law = randomLuGre(random, stiffness, kind.shears == Shears::kAnyBristles);
  }
  return sensor;
}

// Next pose of an object that rolls, slides, lifts a little or rests.
Pose nextPose(Random& random, const Pose& X_SO, double thickness, double size) {
  if (random.chance(0.15)) return X_SO;
  const Vector3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1) + 1e-3};
  Pose next{X_SO.position, axisAngle(axis, random.uniform(0, 0.02) * size) * X_SO.rotation};
  for (double& coordinate : next.position) coordinate += random.uniform(-0.2, 0.2) * thickness * size;
  return next;
}

// Expects shear and wrench of one instance inside the bounds of its twin. Returns the width of the bounds relative to the cone, if the cone
// exceeds kWhisper.
std::optional<double> expectShearOfTwin(const FrameView& frame, std::size_t i, const Sensor& sensor, const Tracked& twin,
                                        const support::FrameEnvelope& envelope) {
  const double mu = coneOf(sensor);
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  const std::vector<double> bound = reference::spread(sensor, twin.taxel_error);
  double width = 0, cone = 0;
  std::size_t num_wrong = 0;
  for (std::size_t t = 0; t < num_taxels; ++t) {
    const double slack = bound[t] + 200 * support::kUlp * mu * twin.frame.spread_force[t] + 1e-9;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double found = frame.ground_truth.tactile_shear_force[2 * (i * num_taxels + t) + axis];
      num_wrong += std::abs(found - twin.frame.spread_shear[t][axis]) <= slack ? 0 : 1;
    }
    width += twin.taxel_error[t];
    cone += mu * twin.frame.contact.taxel_force[t];
  }
  EXPECT_EQ(num_wrong, 0u);
  // The wrench: shear with lever arms up to the extent of the sensor, plus the bounds of the pressures.
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const double arm = axis < 3 ? 1 : 0.1;  // m, of the torques
    const double slack = arm * (width + support::kRelativeMoment * (envelope.total_high + cone) + support::kAbsoluteForce) + 1e-9;
    const double found = frame.ground_truth.contact_wrench[6 * i + axis] - twin.frame.shear.wrench[axis];
    EXPECT_GE(found, envelope.wrench.low[axis] - slack) << "wrench[" << axis << "]";
    EXPECT_LE(found, envelope.wrench.high[axis] + slack) << "wrench[" << axis << "]";
  }
  return cone > kWhisper ? std::optional(width / cone) : std::nullopt;
}

void runPath(const PathKind& kind, int seed) {
  Random random(static_cast<std::uint64_t>(seed));
  const Sensor sensor = randomFrictionSensor(random, kind);
  const std::vector<Object> objects = support::randomObjects(random, kNumObjects, kObjectSize, kind.solid_share, kind.all_convex);
  constexpr int kNumInstances = 2;
  std::vector<Touch> touches(kNumInstances);
  std::vector<float> loads;
  for (Touch& touch : touches) {
    for (int slot = 0; slot < kind.num_slots; ++slot) {
      touch.ids.push_back(random.integer(0, kNumObjects - 1));
      touch.X_SO.push_back(isTaxelList(sensor) && !kind.with_loads
                               ? support::randomContactOnTaxel(random, sensor, objects[touch.ids.back()])
                               : support::randomContact(random, sensor, objects[touch.ids.back()]));
    }
    loads.push_back(kind.with_loads ? static_cast<float>(random.uniform(0.01, 0.5)) : kPoseDriven);
  }
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects, .contact_workgroup = support::randomWorkgroup(random)});
  Simulator simulator(model, {.num_instances = kNumInstances, .num_slots = kind.num_slots});
  simulator.setLoads(loads);
  std::vector<Tracked> tracked(kNumInstances);
  std::vector<double> looseness;
  for (int step = 0; step < kNumSteps; ++step) {
    support::setTouches(simulator, touches);
    const double dt = kind.shears == Shears::kSprings ? 1e-3 : std::pow(10, random.uniform(-4, 1));
    const FrameView frame = support::stepOnce(simulator, dt);
    support::expectWellFormed(frame, sensor, kNumInstances);
    for (std::size_t i = 0; i < kNumInstances; ++i) {
      SCOPED_TRACE("step " + std::to_string(step) + ", instance " + std::to_string(i));
      const auto placed = touches[i].placed(objects, frame.ground_truth.load_offset[i]);
      support::Rounding rounding = support::roundingFor(sensor, placed);
      // A load search rounds the pose once more.
      rounding.margin_z += (kind.num_slots > 1 ? kSlotRounding : 0) + (kind.with_loads ? support::kMarginZ : 0);
      tracked[i] = advance(sensor, placed, rounding, tracked[i], dt, kind.num_slots > 1 ? 0x1p-20 : 0);
      const auto relative = expectShearOfTwin(frame, i, sensor, tracked[i], support::frameEnvelope(sensor, placed, rounding));
      if (relative) looseness.push_back(*relative);
    }
    // Bristles reach their largest bend after about 10 um.
    const double size = kind.shears == Shears::kSprings ? 1 : std::pow(10, random.uniform(-3, 0));
    for (Touch& touch : touches) {
      for (Pose& X_SO : touch.X_SO) X_SO = nextPose(random, X_SO, sensor.skin.thickness, size);
    }
  }
  if (kind.shears != Shears::kAnyBristles) support::expectMedianAtMost(looseness, kLoosest);
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

TEST_P(FrictionTwinSeeds, TaxelLists) {
  runPath({.sensor = {}, .curved = GetParam() % 4, .num_slots = 1 + GetParam() / 4}, 5000 + GetParam());
}

TEST_P(FrictionTwinSeeds, BristlesOnTaxelLists) {
  runPath({.sensor = {}, .curved = GetParam() % 4, .shears = Shears::kBristles, .num_slots = 1 + GetParam() / 4}, 5500 + GetParam());
}

TEST_P(FrictionTwinSeeds, TaxelListsUnderALoad) {
  runPath({.sensor = {}, .curved = GetParam() % 4, .all_convex = true, .with_loads = true}, 6000 + GetParam());
}

TEST_P(FrictionTwinSeeds, Bristles) {
  runPath({.sensor = {}, .shears = Shears::kBristles}, 9000 + GetParam());
}

TEST_P(FrictionTwinSeeds, BristlesUnderSeveralObjectsAndPatches) {
  runPath({.sensor = {.max_rows = 8, .max_cols = 8, .max_patches = 1 + GetParam() % 3, .max_patch_tilt = 0.5},
           .shears = Shears::kBristles,
           .num_slots = 1 + GetParam() % 3},
          6000 + GetParam());
}

TEST_P(FrictionTwinSeeds, BristlesUnderALoad) {
  runPath({.sensor = {.max_rows = 8, .max_cols = 8, .max_patches = 1 + GetParam() % 2}, .shears = Shears::kBristles, .with_loads = true},
          7000 + GetParam());
}

TEST_P(FrictionTwinSeeds, ExtremeBristles) {
  runPath({.sensor = {}, .shears = Shears::kAnyBristles, .num_slots = 1 + GetParam() % 2}, 8000 + GetParam());
}

INSTANTIATE_TEST_SUITE_P(OnEveryDriver, FrictionTwinSeeds, support::seeds(4, 8));

}  // namespace
}  // namespace taxelsim
