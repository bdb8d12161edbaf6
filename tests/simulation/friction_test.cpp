// Shear with memory on the device: closed forms, and what must hold on any path.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reference/psf.h"
#include "simulation/comparison.h"
#include "support/friction_cases.h"
#include "support/random_scene.h"

namespace taxelsim {
namespace {

using support::FrictionCases;
using support::Push;
using support::Random;
using support::Touch;

constexpr double kDt = 1e-3;  // s
// Depths are off by kMarginZ at most; the contacts of the cases are at least this deep on average.
constexpr double kMeanDepth = 0.1e-3;  // m

std::vector<std::vector<Push>> simulateByDevice(const Sensor& sensor, const Object& object, const std::vector<support::Path>& paths) {
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {object}});
  Simulator simulator(model, {.num_instances = static_cast<int>(paths.size())});
  std::vector<std::vector<Push>> result(paths.size());
  for (std::size_t step = 0; step < paths[0].size(); ++step) {
    std::vector<Touch> touches;
    for (const support::Path& path : paths) touches.push_back({{0}, {path[step]}});
    support::setTouches(simulator, touches);
    simulator.step(kDt);
    const FrameView frame = simulator.read();
    for (std::size_t i = 0; i < paths.size(); ++i) {
      Push push{.normal = frame.ground_truth.total_force[i]};
      std::copy_n(frame.ground_truth.contact_wrench.begin() + static_cast<std::ptrdiff_t>(6 * i), 6, push.wrench.begin());
      result[i].push_back(push);
    }
  }
  return result;
}

std::vector<Push> pushesOf(const Sensor& sensor, const Object& object, const support::Path& path) {
  return simulateByDevice(sensor, object, {path}).front();
}

const FrictionCases kDevice{simulateByDevice, support::kMarginZ / kMeanDepth};

TEST(FrictionOnDevice, DiscTwist) {
  kDevice.discTwist();
}
TEST(FrictionOnDevice, SphereTwist) {
  kDevice.sphereTwist();
}
TEST(FrictionOnDevice, PartialSlipOfAFlat) {
  kDevice.partialSlipOfAFlat();
}
TEST(FrictionOnDevice, PartialSlipOfASphere) {
  kDevice.partialSlipOfASphere();
}
TEST(FrictionOnDevice, PartialSlipOfACylinder) {
  kDevice.partialSlipOfACylinder();
}
TEST(FrictionOnDevice, LoopAreas) {
  kDevice.loopAreas();
}
TEST(FrictionOnDevice, SlantedPress) {
  kDevice.slantedPress();
}
TEST(FrictionOnDevice, RollingCylinder) {
  kDevice.rollingCylinder();
}
TEST(FrictionOnDevice, RollingSphere) {
  kDevice.rollingSphere();
}
TEST(FrictionOnDevice, SlideStopSlideBack) {
  kDevice.slideStopSlideBack();
}
TEST(FrictionOnDevice, SlipTurnsTowardsTheMotion) {
  kDevice.slipTurnsTowardsTheMotion();
}
TEST(FrictionOnDevice, ElasticLayerSticksAndSlips) {
  kDevice.elasticLayerSticksAndSlips();
}

// A sensor with friction and everything that takes another way through the passes: two patches, one tilted, a PSF of its own.
Sensor busySensor() {
  Sensor sensor = support::gridSensor({.num_rows = 5, .num_cols = 7, .samples_per_taxel = 3, .law = {1.73e8, 1, 1e4}});
  sensor.patches.push_back(sensor.patches[0]);
  sensor.patches[1].name = "second";
  sensor.patches[1].X_SP = {{0.02, 0, 0}, axisAngle({0, 1, 0}, 0.1)};
  sensor.psf = gaussianPsf(0.8, 5);
  sensor.skin.friction = {0.4e8, 0.7};
  return sensor;
}

// The same with the bristles of LuGre instead of springs, which creep and slip by how fast an object goes.
Sensor bristlySensor() {
  Sensor sensor = busySensor();
  sensor.skin.friction = {};
  sensor.skin.law = LuGre{.normal_contact_stiffness = 1.73e8};
  return sensor;
}

// Instances that roll and slide about, lift off and touch again, some of them under a load.
struct Paths {
  std::vector<Object> objects;
  std::vector<std::vector<Touch>> touches;  // (steps x instances)
  std::vector<float> loads;
};

Pose nudged(Random& random, const Pose& X_SO, double size) {
  const Vector3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1) + 1e-3};
  Pose moved{X_SO.position, axisAngle(axis, random.uniform(-1, 1) * size / 0.01) * X_SO.rotation};
  for (double& coordinate : moved.position) coordinate += random.uniform(-1, 1) * size;
  return moved;
}

Paths randomPaths(const Sensor& sensor, int num_instances, int num_slots, bool with_loads, double step_size = 0.2e-3) {
  constexpr int kNumSteps = 6;
  Random random(8);
  Paths paths;
  for (int n = 0; n < 4; ++n) paths.objects.push_back(n % 2 ? support::randomSolid(random, 0.02) : support::randomMeshObject(random, 0.02));
  paths.touches.resize(kNumSteps);
  for (int i = 0; i < num_instances; ++i) {
    Touch touch;
    for (int slot = 0; slot < num_slots; ++slot) {
      touch.ids.push_back(random.integer(0, 3));
      touch.X_SO.push_back(support::randomContact(random, sensor, paths.objects[touch.ids.back()]));
    }
    for (std::vector<Touch>& step : paths.touches) {
      step.push_back(touch);
      for (Pose& X_SO : touch.X_SO) X_SO = nudged(random, X_SO, step_size);
    }
    paths.loads.push_back(with_loads && i % 3 == 2 ? static_cast<float>(random.uniform(0.1, 2)) : kPoseDriven);
  }
  return paths;
}

// The instances given, in that order, along their paths; bits of each after every step.
std::vector<std::vector<std::uint32_t>> runPaths(const Model& model, const Paths& paths, const std::vector<int>& instances,
                                                 const std::vector<double>& dt = {kDt}) {
  const int n = static_cast<int>(instances.size());
  Simulator simulator(model, {.num_instances = n, .num_slots = static_cast<int>(paths.touches[0][0].ids.size())});
  std::vector<std::vector<std::uint32_t>> bits(instances.size());
  for (int i = 0; i < n; ++i) simulator.setLoad(i, paths.loads[instances[i]]);
  for (std::size_t step = 0; step < paths.touches.size(); ++step) {
    std::vector<Touch> touches;
    for (const int instance : instances) touches.push_back(paths.touches[step][instance]);
    support::setTouches(simulator, touches);
    simulator.step(dt[step % dt.size()]);
    const FrameView frame = simulator.read();
    support::expectWellFormed(frame, model.sensor(), n);
    for (int i = 0; i < n; ++i) {
      const std::vector<std::uint32_t> now = support::bitsOf(frame, i, n);
      bits[i].insert(bits[i].end(), now.begin(), now.end());
    }
  }
  return bits;
}

std::vector<int> upTo(int count) {
  std::vector<int> numbers;
  for (int n = 0; n < count; ++n) numbers.push_back(n);
  return numbers;
}

struct StateKind {
  int num_slots = 1;
  int num_patches = 2;
  bool has_friction = true;
  bool relaxes = false;
  bool bristles = false;
};

class StateBatch : public ::testing::TestWithParam<StateKind> {};

TEST_P(StateBatch, AnInstanceIsTheSameInAnyBatchAndWorkgroup) {
  const StateKind kind = GetParam();
  Sensor sensor = kind.bristles ? bristlySensor() : busySensor();
  sensor.patches.resize(static_cast<std::size_t>(kind.num_patches));
  if (!kind.has_friction) sensor.skin.friction = {};
  if (kind.relaxes) {
    if (Winkler* law = std::get_if<Winkler>(&sensor.skin.law)) law->normal_damping = 0;
    sensor.skin.relaxation = {{0.3, 1e-3}, {0.4, 0.01}, {0.1, 1}};
  }
  constexpr int kNumInstances = 13;
  const Paths paths = randomPaths(sensor, kNumInstances, kind.num_slots, true);
  const auto model = [&](int contact_workgroup, int image_workgroup) {
    return Model(support::sharedDevice(),
                 {.sensor = sensor, .objects = paths.objects, .contact_workgroup = contact_workgroup, .image_workgroup = image_workgroup});
  };
  const Model usual = model(0, 0);
  const auto together = runPaths(usual, paths, upTo(kNumInstances));
  std::vector<int> backwards = upTo(kNumInstances);
  std::reverse(backwards.begin(), backwards.end());
  const auto reversed = runPaths(usual, paths, backwards);
  for (int i = 0; i < kNumInstances; ++i) EXPECT_EQ(together[i], reversed[kNumInstances - 1 - i]) << "instance " << i;
  for (const int i : {0, 2, 7}) EXPECT_EQ(together[i], runPaths(usual, paths, {i})[0]) << "instance " << i;
  EXPECT_EQ(runPaths(model(32, 64), paths, upTo(kNumInstances)), together);
  EXPECT_EQ(runPaths(model(128, 16), paths, upTo(kNumInstances)), together);
}

INSTANTIATE_TEST_SUITE_P(Kinds, StateBatch,
                         ::testing::Values(StateKind{}, StateKind{.num_slots = 2}, StateKind{.has_friction = false, .relaxes = true},
                                           StateKind{.num_patches = 1, .has_friction = false, .relaxes = true},
                                           StateKind{.num_slots = 2, .num_patches = 1, .relaxes = true}, StateKind{.relaxes = true},
                                           StateKind{.bristles = true}, StateKind{.num_slots = 2, .relaxes = true, .bristles = true}));

// Without a damper nothing knows how long a step takes.
TEST(FrictionOnDevice, SpeedDoesNotShow) {
  Sensor sensor = busySensor();
  sensor.skin.law = Winkler{1.73e8, 1, 0};
  const Paths paths = randomPaths(sensor, 5, 1, false);
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = paths.objects});
  const auto slow = runPaths(model, paths, upTo(5), {0.5, 2});
  EXPECT_EQ(runPaths(model, paths, upTo(5), {1e-4}), slow);
}

TEST(FrictionOnDevice, AnObjectAtRestDoesNotCreep) {
  const Sensor sensor = support::gridSensor();
  Sensor with_friction = sensor;
  with_friction.skin.friction = {1e8, 0.6};
  const Model model(support::sharedDevice(), {.sensor = with_friction, .objects = {Object(Sphere{0.01})}});
  Simulator simulator(model, {.num_instances = 2});
  // Far from S's origin and turned, where float32 poses would differ from themselves by rounding.
  const Pose start{{4e-3, 17e-3, 0.0094}, axisAngle({1, 2, 3}, 1.1)};
  Pose slid = start;
  slid.position[0] += 0.05e-3;
  const auto stepTo = [&](const Pose& X_SO) {
    support::setTouches(simulator, {{{0}, {X_SO}}, {{0}, {X_SO}}});
    simulator.step(kDt);
    return support::bitsOf(simulator.read(), 1, 2);
  };
  simulator.setLoad(1, 2.0f);
  stepTo(start);
  const auto bits = stepTo(slid);
  for (int n = 0; n < 100; ++n) ASSERT_EQ(stepTo(slid), bits) << "step " << n;
  EXPECT_GT(simulator.read().ground_truth.contact_wrench[6], 0.1f);
}

// |sum of shear| <= mu (sum of normal force), per taxel too, after the PSF as before it: both spread with the same weights.
TEST(FrictionOnDevice, ShearStaysInsideTheConeAtAnyStiffness) {
  // Products with four factors and sums of up to 64 samples and 81 neighbours, each rounded.
  constexpr double kRounding = 300 * support::kUlp;
  for (const double stiffness : {1e-6, 1.0, 1e6}) {
    for (const double mu : {1e-3, 10.0}) {
      for (const double step_size : {1e-6, 0.3e-3, 0.02}) {
        Sensor sensor = busySensor();
        sensor.skin.friction = {stiffness * 0.4e8, mu};
        const Paths paths = randomPaths(sensor, 4, 1, true, step_size);
        const Model model(support::sharedDevice(), {.sensor = sensor, .objects = paths.objects});
        Simulator simulator(model, {.num_instances = 4});
        simulator.setLoads(paths.loads);
        for (const std::vector<Touch>& touches : paths.touches) {
          support::setTouches(simulator, touches);
          simulator.step(kDt);
          const FrameView frame = simulator.read();
          support::expectWellFormed(frame, sensor, 4);
          const auto normal = frame.ground_truth.tactile_normal_force, shear = frame.ground_truth.tactile_shear_force;
          std::size_t num_outside = 0;
          for (std::size_t t = 0; t < normal.size(); ++t) {
            num_outside += std::hypot(shear[2 * t], shear[2 * t + 1]) > mu * normal[t] * (1 + kRounding) ? 1 : 0;
          }
          EXPECT_EQ(num_outside, 0u) << stiffness << " " << mu << " " << step_size;
        }
      }
    }
  }
}

// A flat on whole samples at the ends of the range: nothing slips under a spring a million times too soft, everything under one a million
// times too hard.
TEST(FrictionOnDevice, ExtremeStiffnessGivesTheClosedForm) {
  const double depth = 0.5e-3, side = 4e-3, slide = 0.1e-3, normal = 1.73e8 * depth * side * side;
  for (const double stiffness : {1e-6, 1e6}) {
    for (const double mu : {1e-3, 10.0}) {
      Sensor sensor = support::gridSensor({.num_rows = 12, .num_cols = 12, .pitch_x = 1e-3, .pitch_y = 1e-3});
      sensor.skin.friction = {stiffness * 1e8, mu};
      const std::vector<Push> pushes =
          pushesOf(sensor, Object(Box{{side, side, 0.01}}),
                   {{.position = {0.02e-3, 0.02e-3, 5e-3 - depth}}, {.position = {0.02e-3, 0.02e-3 - slide, 5e-3 - depth}}});
      const double expected = -std::min(stiffness * 1e8 * slide * side * side, mu * normal);
      EXPECT_NEAR(pushes[1].wrench[1] / expected, 1, support::kMarginZ / depth) << stiffness << " " << mu;
    }
  }
}

TEST(FrictionOnDevice, SpreadKeepsTheSumAndTheWeights) {
  Sensor plain = support::gridSensor({.num_rows = 5, .num_cols = 8});
  plain.skin.friction = {1e8, 0.6};
  for (const int size : {3, 5}) {
    Sensor spread = plain;
    spread.psf = gaussianPsf(0.7, size);
    const auto shearOf = [&](const Sensor& sensor) {
      const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.02})}});
      Simulator simulator(model, {});
      for (const double slide : {0.0, 0.3e-3}) {
        support::setTouches(simulator, {{{0}, {{.position = {-4e-3 + slide, 2e-3 + slide / 3, 0.0193}}}}});
        simulator.step(kDt);
        simulator.read();
      }
      const auto shear = simulator.read().ground_truth.tactile_shear_force;
      std::vector<std::vector<double>> components(2);
      for (std::size_t n = 0; n < shear.size(); ++n) components[n % 2].push_back(shear[n]);
      return components;
    };
    const auto before = shearOf(plain), after = shearOf(spread);
    for (int axis = 0; axis < 2; ++axis) {
      const std::vector<double> expected = reference::spread(spread, before[axis]);
      double sum_before = 0, sum_after = 0;
      for (std::size_t t = 0; t < expected.size(); ++t) {
        sum_before += before[axis][t];
        sum_after += after[axis][t];
        EXPECT_NEAR(after[axis][t], expected[t], 100 * support::kUlp);  // of about a newton
      }
      EXPECT_GT(sum_before, 0.1);
      EXPECT_NEAR(sum_after / sum_before, 1, 300 * support::kUlp);
    }
  }
}

// Shear along x after a slide of 0.1 mm, N; `between` may meddle before the slide.
template <typename Meddle>
double shearAfterSlide(const Model& model, int num_slots, Meddle&& meddle) {
  Simulator simulator(model, {.num_slots = num_slots});
  Touch touch{{0}, {{.position = {0, 0, 0.0095}}}};
  touch.ids.resize(static_cast<std::size_t>(num_slots), kNoObject);
  touch.X_SO.resize(static_cast<std::size_t>(num_slots));
  support::setTouches(simulator, {touch});
  simulator.step(kDt);
  simulator.read();
  touch.X_SO[0].position[0] += 0.1e-3;
  meddle(simulator, touch);
  support::setTouches(simulator, {touch});
  simulator.step(kDt);
  return simulator.read().ground_truth.contact_wrench[0];
}

void expectNewObjectsBeginWithoutShear(const Sensor& sensor) {
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.01}), Object(Sphere{0.01})}});
  for (const int num_slots : {1, 2}) {
    EXPECT_GT(shearAfterSlide(model, num_slots, [](Simulator&, Touch&) {}), 0.1);
    EXPECT_EQ(shearAfterSlide(model, num_slots, [](Simulator& simulator, Touch&) { simulator.reset(0, 1); }), 0);
    EXPECT_EQ(shearAfterSlide(model, num_slots, [](Simulator&, Touch& touch) { touch.ids[0] = 1; }), 0);
  }
  // The same object in another slot is a new one there.
  EXPECT_EQ(shearAfterSlide(
                model, 2, [](Simulator&, Touch& touch) { std::swap(touch.ids[0], touch.ids[1]), std::swap(touch.X_SO[0], touch.X_SO[1]); }),
            0);
}

TEST(FrictionOnDevice, NewObjectsAndEpisodesBeginWithoutShear) {
  Sensor sensor = support::gridSensor();
  sensor.skin.friction = {1e8, 0.6};
  expectNewObjectsBeginWithoutShear(sensor);
  sensor.skin = {sensor.skin.thickness, LuGre{.normal_contact_stiffness = 1.73e8}, {}};
  expectNewObjectsBeginWithoutShear(sensor);
}

// One object is drawn along and lifted while another comes down in its place: its springs are new, though the samples have not been free.
TEST(FrictionOnDevice, AnObjectDoesNotInheritAnothersShear) {
  Sensor sensor = support::gridSensor();
  sensor.skin.friction = {1e8, 0.6};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Box{{8e-3, 8e-3, 0.01}})}});
  Simulator simulator(model, {.num_slots = 2});
  const auto shearAt = [&](const Vector3& first, const Vector3& second) {
    support::setTouches(simulator, {{{0, 0}, {{.position = first}, {.position = second}}}});
    simulator.step(kDt);
    return simulator.read().ground_truth.contact_wrench[0];
  };
  EXPECT_EQ(shearAt({0, 0, 4.5e-3}, {0, 0, 0.03}), 0);
  EXPECT_GT(shearAt({0.1e-3, 0, 4.5e-3}, {0, 0, 0.03}), 0.1);
  EXPECT_EQ(shearAt({0.1e-3, 0, 0.03}, {0, 0, 4.5e-3}), 0);
  EXPECT_GT(shearAt({0.1e-3, 0, 0.03}, {0.1e-3, 0, 4.5e-3}), 0.1);
}

// Out of contact and back: the spring has been let go.
TEST(FrictionOnDevice, SeparationForgets) {
  Sensor sensor = support::gridSensor();
  sensor.skin.friction = {1e8, 0.6};
  const std::vector<Push> pushes = pushesOf(sensor, Object(Sphere{0.01}),
                                            {{.position = {0, 0, 0.0095}},
                                             {.position = {0.1e-3, 0, 0.0095}},
                                             {.position = {0.1e-3, 0, 0.0101}},
                                             {.position = {0.1e-3, 0, 0.0095}}});
  EXPECT_GT(pushes[1].wrench[0], 0.1);
  EXPECT_EQ(pushes[2].wrench[0], 0);
  EXPECT_EQ(pushes[3].wrench[0], 0);
}

// Dragged far under a load, along S's x over level patches: the whole of it at the cone, in one tile and over several.
TEST(FrictionOnDevice, ALoadThatSlidesShearsWithMuTimesTheLoad) {
  for (const int num_patches : {1, 2}) {
    Sensor sensor = support::gridSensor();
    for (int p = 1; p < num_patches; ++p) {
      sensor.patches.push_back(sensor.patches[0]);
      sensor.patches.back().X_SP.position = {6 * 3.4e-3, 0, 0};
    }
    sensor.skin.friction = {1e8, 0.6};
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.02})}});
    Simulator simulator(model, {});
    simulator.setLoad(0, 3.0f);
    for (int n = 0; n < 40; ++n) {
      support::setTouches(simulator, {{{0}, {{.position = {0.1e-3 * n, 0, 0.03}}}}});
      simulator.step(kDt);
      const auto wrench = simulator.read().ground_truth.contact_wrench;
      constexpr double kCarried = 1e-4;  // of the load, by the search
      EXPECT_NEAR(wrench[2], -3, 3 * kCarried);
      EXPECT_NEAR(wrench[1], 0, 0.01 * 3);
      // Springs at the leading edge may not have slipped yet; they carry little.
      const double slips = n == 0 ? 0 : 1;
      if (n > 30 || n == 0) {
        EXPECT_NEAR(wrench[0], 0.6 * 3 * slips, 0.01 * 3 * slips);
      }
    }
  }
}

TEST(FrictionOnDevice, WithoutFrictionThereIsNoShear) {
  const Sensor sensor = support::gridSensor();
  const std::vector<Push> pushes =
      pushesOf(sensor, Object(Sphere{0.01}), {{.position = {0, 0, 0.0095}}, {.position = {0.1e-3, 0, 0.0095}}});
  EXPECT_EQ(pushes[1].wrench[0], 0);
  EXPECT_EQ(pushes[1].wrench[5], 0);
}

}  // namespace
}  // namespace taxelsim
