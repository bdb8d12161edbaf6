// A skin that relaxes on the device: closed forms, the twin on random paths, and what must hold on any.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reference/contact.h"
#include "reference/load.h"
#include "simulation/comparison.h"
#include "support/curved_sensor.h"
#include "support/random_scene.h"
#include "support/relaxation_cases.h"

namespace taxelsim {
namespace {

using support::Press;
using support::Pressed;
using support::Random;
using support::RelaxationCases;
using support::Touch;

// The root find stops at this share of the load, in float32 sums.
constexpr double kCarried = 1e-4;

std::vector<Pressed> simulateByDevice(const Sensor& sensor, const Object& object, const std::vector<Press>& steps) {
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {object}});
  Simulator simulator(model, {});
  std::vector<Pressed> result;
  for (const Press& step : steps) {
    support::setTouches(simulator, {{{0}, {step.X_SO}}});
    simulator.setLoad(0, step.load ? static_cast<float>(*step.load) : kPoseDriven);
    simulator.step(step.dt);
    const GroundTruthView truth = simulator.read().ground_truth;
    const auto forces = truth.tactile_normal_force;
    result.push_back(
        {truth.total_force[0], *std::min_element(forces.begin(), forces.end()), truth.load_offset[0], truth.load_reached[0] > 0});
  }
  return result;
}

const RelaxationCases kDevice{simulateByDevice, support::kMarginZ};

TEST(RelaxationOnDevice, StepOfDepth) {
  kDevice.stepOfDepth();
}
TEST(RelaxationOnDevice, AnyTimes) {
  kDevice.anyTimes();
}
TEST(RelaxationOnDevice, Ramp) {
  kDevice.ramp();
}
TEST(RelaxationOnDevice, GrowingSphere) {
  kDevice.growingSphere();
}
TEST(RelaxationOnDevice, DeadLoadOnAFlat) {
  kDevice.deadLoadOnAFlat();
}
TEST(RelaxationOnDevice, DeadLoadOnASphere) {
  kDevice.deadLoadOnASphere();
}
TEST(RelaxationOnDevice, FreeRecovery) {
  kDevice.freeRecovery();
}
TEST(RelaxationOnDevice, PressedAgain) {
  kDevice.pressedAgain();
}
TEST(RelaxationOnDevice, LossOfACycle) {
  kDevice.lossOfACycle();
}
TEST(RelaxationOnDevice, CyclesLose) {
  kDevice.cyclesLose();
}
TEST(RelaxationOnDevice, LayerUnderAPunch) {
  kDevice.layerUnderAPunch();
}
TEST(RelaxationOnDevice, LayerUnderASphere) {
  kDevice.layerUnderASphere();
}

// ---- the twin ----

constexpr double kObjectSize = 0.02;  // m
constexpr int kNumSteps = 9;
constexpr int kResetStep = 7;
// Bounds wider than this, relative to the force, would prove little; silhouettes and whispers may have them, half of a path's frames not.
constexpr double kLoosest = 0.1;
constexpr double kWhisper = 1e-2;  // N

struct PathKind {
  support::SensorRange sensor;
  int curved = -1;  // instead: number of a curvedSensor()
  double solid_share = 0.5;
  bool all_convex = false;
  int num_slots = 1;
  bool with_loads = false;
  bool is_level = true;
};

std::vector<RelaxationTerm> randomTerms(Random& random, int num_terms) {
  std::vector<RelaxationTerm> terms;
  double sum = 0;
  for (int m = 0; m < num_terms; ++m) {
    terms.push_back({random.uniform(0.1, 1), 1e-3 * std::pow(10, random.uniform(-3, 3))});
    sum += terms.back().fraction;
  }
  const double all = random.chance(0.2) ? 0.999 : random.uniform(0.1, 0.9);
  for (RelaxationTerm& term : terms) term.fraction *= all / sum;
  return terms;
}

// What is known of one instance: bounds of its skin's past, and the twin's own.
struct Tracked {
  explicit Tracked(const Sensor& sensor) : bounds(sensor.skin.relaxation), skin(sensor.skin.relaxation) {}

  support::SkinEnvelope bounds;
  reference::SkinHistory skin;
};

void runPath(const PathKind& kind, int seed) {
  Random random(static_cast<std::uint64_t>(seed));
  Sensor sensor = kind.curved >= 0 ? support::curvedSensor(random, kind.curved) : support::randomSensor(random, kind.sensor);
  sensor.samples_per_taxel = random.integer(1, 5);
  sensor.skin.relaxation = randomTerms(random, 1 + seed % kMaxRelaxationTerms);
  std::vector<Object> objects;
  for (int n = 0; n < 3; ++n) {
    objects.push_back(random.chance(kind.solid_share) ? support::randomSolid(random, kObjectSize)
                      : kind.all_convex               ? support::randomPolyhedron(random, kObjectSize)
                                                      : support::randomMeshObject(random, kObjectSize));
  }
  constexpr int kNumInstances = 3;
  std::vector<Touch> touches(kNumInstances), elsewhere(kNumInstances);
  for (std::vector<Touch>* places : {&touches, &elsewhere}) {
    for (Touch& touch : *places) {
      for (int slot = 0; slot < kind.num_slots; ++slot) {
        touch.ids.push_back(random.integer(0, 2));
        const Object& object = objects[touch.ids.back()];
        touch.X_SO.push_back(kind.curved >= 0 ? support::randomContactOnTaxel(random, sensor, object)
                                              : support::randomContact(random, sensor, object));
      }
    }
  }
  const int workgroups[] = {0, 4, 8, 16, 32, 64, 128, 256};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects, .contact_workgroup = workgroups[random.integer(0, 7)]});
  Simulator simulator(model, {.num_instances = kNumInstances, .num_slots = kind.num_slots});
  std::vector<Tracked> tracked(kNumInstances, Tracked(sensor));
  std::vector<double> looseness;
  for (int step = 0; step < kNumSteps; ++step) {
    const double dt = 1e-3 * std::pow(10, random.uniform(-3, 3));
    if (step == kResetStep) {
      simulator.reset(1, 1);
      tracked[1] = Tracked(sensor);
    }
    std::vector<float> loads(kNumInstances, kPoseDriven);
    std::vector<reference::LoadResult> expected(kNumInstances);
    for (int i = 0; kind.with_loads && i + 1 < kNumInstances; ++i) {  // the last stays driven by its pose
      const auto placed = touches[i].placed(objects);
      const reference::SkinStep skin = tracked[i].skin.step(dt);
      const auto all_of_it = reference::findLoad(sensor, placed, 1e9, skin);
      const auto d = reference::penetrations(reference::surfaceHeights(sensor, reference::movedAlongZ(placed, all_of_it.full_depth)),
                                             sensor.skin.thickness);
      const double full = reference::computeContact(sensor, d, {}, dt, skin).total_force;
      loads[i] = static_cast<float>(full > 1e-3 ? full * random.uniform(0.02, 0.95) : 0.1);
      expected[i] = reference::findLoad(sensor, placed, loads[i], skin);
    }
    support::setTouches(simulator, touches);
    simulator.setLoads(loads);
    simulator.step(dt);
    const FrameView frame = simulator.read();
    support::expectWellFormed(frame, sensor, kNumInstances);
    const auto& forces = frame.ground_truth.tactile_normal_force;
    EXPECT_GE(*std::min_element(forces.begin(), forces.end()), 0);
    for (int i = 0; i < kNumInstances; ++i) {
      SCOPED_TRACE("step " + std::to_string(step) + ", instance " + std::to_string(i));
      const bool driven = !std::isnan(loads[i]);
      const double offset = frame.ground_truth.load_offset[i];
      const auto placed = touches[i].placed(objects, offset);
      support::Rounding rounding = support::roundingFor(sensor, placed);
      // A pose that a load search moves is rounded once more.
      rounding.margin_z += driven ? support::kMarginZ : 0;
      const auto envelope = support::frameEnvelope(sensor, placed, rounding, {}, dt, &tracked[i].bounds);
      support::expectMatches(frame, i, sensor, envelope);
      if (envelope.total_high > kWhisper) looseness.push_back((envelope.total_high - envelope.total_low) / envelope.total_high);
      const auto d = reference::penetrations(reference::surfaceHeights(sensor, placed), sensor.skin.thickness);
      tracked[i].skin.advance(dt, reference::computeContact(sensor, d, {}, dt, tracked[i].skin.step(dt)).strain);
      if (!driven || !kind.is_level) continue;
      EXPECT_EQ(frame.ground_truth.load_reached[i], expected[i].reached ? 1 : 0);
      if (!expected[i].reached) continue;
      EXPECT_NEAR(-frame.ground_truth.contact_wrench[6 * i + 2], loads[i], kCarried * loads[i] + support::kAbsoluteForce);
      EXPECT_NEAR(offset, expected[i].offset, kCarried * sensor.skin.thickness + 2 * rounding.margin_z);
    }
    for (std::size_t i = 0; i < touches.size(); ++i) {
      // Elsewhere, and back to where the skin has had time to recover; or on from here.
      if (random.chance(0.4)) {
        std::swap(touches[i], elsewhere[i]);
        continue;
      }
      for (Pose& X_SO : touches[i].X_SO) {
        if (random.chance(0.2)) continue;
        const Vector3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1) + 1e-3};
        X_SO.rotation = axisAngle(axis, random.uniform(0, 0.05)) * X_SO.rotation;
        for (double& coordinate : X_SO.position) coordinate += random.uniform(-0.4, 0.4) * sensor.skin.thickness;
      }
    }
  }
  if (looseness.empty()) return;
  const auto middle = looseness.begin() + static_cast<std::ptrdiff_t>(looseness.size() / 2);
  std::nth_element(looseness.begin(), middle, looseness.end());
  EXPECT_LE(*middle, kLoosest);
}

class RelaxationTwinSeeds : public ::testing::TestWithParam<int> {};

TEST_P(RelaxationTwinSeeds, OneObject) {
  runPath({.sensor = {}}, GetParam());
}

TEST_P(RelaxationTwinSeeds, Polyhedron) {
  runPath({.sensor = {}, .solid_share = 0, .all_convex = true}, 1000 + GetParam());
}

TEST_P(RelaxationTwinSeeds, SeveralObjectsOnTiltedPatches) {
  runPath({.sensor = {.max_rows = 8, .max_cols = 8, .max_patches = 3, .max_patch_tilt = 0.5}, .num_slots = 1 + GetParam() % 2},
          2000 + GetParam());
}

TEST_P(RelaxationTwinSeeds, UnderALoad) {
  runPath({.sensor = {.max_rows = 8, .max_cols = 8, .max_patches = 1 + GetParam() % 2},
           .num_slots = 1 + GetParam() / 2 % 2,
           .with_loads = true},
          3000 + GetParam());
}

TEST_P(RelaxationTwinSeeds, UnderALoadOnTiltedPatches) {
  runPath({.sensor = {.max_rows = 6, .max_cols = 6, .max_patches = 3, .max_patch_tilt = 0.2}, .with_loads = true, .is_level = false},
          4000 + GetParam());
}

TEST_P(RelaxationTwinSeeds, TaxelsWithPlacesOfTheirOwn) {
  runPath({.sensor = {}, .curved = GetParam() % 3, .num_slots = 1 + GetParam() / 6}, 5000 + GetParam());
}

// 1024 x 1024 samples over many tiles.
TEST(RelaxationOnDevice, LargestSensor) {
  Sensor sensor = support::gridSensor({.num_rows = 128, .num_cols = 128, .pitch_x = 0.5e-3, .pitch_y = 0.5e-3, .samples_per_taxel = 4});
  sensor.skin.relaxation = {{0.5, 1e-3}};
  Tracked tracked(sensor);
  const std::vector<Object> objects{Object(Sphere{0.03})};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  Simulator simulator(model, {});
  for (const double depth : {1e-3, 0.8e-3, 1.2e-3}) {
    const Touch touch{{0}, {{.position = {1e-3, 2e-3, 0.03 - depth}}}};
    support::setTouches(simulator, {touch});
    simulator.step(1e-3);
    support::expectMatches(simulator.read(), 0, sensor,
                           support::frameEnvelope(sensor, touch.placed(objects), support::roundingFor(sensor, touch.placed(objects)), {},
                                                  1e-3, &tracked.bounds));
  }
}

INSTANTIATE_TEST_SUITE_P(Random, RelaxationTwinSeeds, ::testing::Range(0, 6));

// ---- what must hold on any path ----

// A load carried for long sinks in, and none of it is lost; in one tile and over several, a mesh and a solid.
TEST(RelaxationOnDevice, ALoadIsCarriedWhileItSinksIn) {
  for (const int num_patches : {1, 2}) {
    Sensor sensor = support::gridSensor();
    sensor.patches.resize(static_cast<std::size_t>(num_patches), sensor.patches[0]);
    if (num_patches > 1) sensor.patches[1].X_SP.position = {6 * 3.4e-3, 0, 0};
    sensor.skin.relaxation = {{0.3, 0.1}, {0.2, 2}};
    for (const Object& object : {Object(Sphere{0.02}), Object("box", support::boxMesh({0.01, 0.012, 0.01}))}) {
      const std::vector<Pressed> pressed =
          simulateByDevice(sensor, object, std::vector<Press>(60, {{.position = {0.3e-3, 1e-3, 0.03}}, 0.05, 2.0}));
      for (std::size_t n = 0; n < pressed.size(); ++n) {
        EXPECT_TRUE(pressed[n].reached);
        EXPECT_NEAR(pressed[n].force, 2, 0.001 * 2);
        if (n > 0) {
          EXPECT_LT(pressed[n].offset, pressed[n - 1].offset + support::kMarginZ);
        }
      }
      EXPECT_LT(pressed.back().offset, pressed.front().offset - 20e-6);
    }
  }
}

// What full depth carries falls with time, to half: a load between is carried at first and then out of reach.
TEST(RelaxationOnDevice, ALoadMayGoOutOfReach) {
  for (const int num_patches : {1, 2}) {
    Sensor sensor = support::gridSensor({.num_rows = 4, .num_cols = 4});
    sensor.patches.resize(static_cast<std::size_t>(num_patches), sensor.patches[0]);
    if (num_patches > 1) sensor.patches[1].X_SP.position = {4 * 3.4e-3, 0, 0};
    sensor.skin.relaxation = {{0.5, 0.1}};
    const double area = num_patches * 16 * 3.4e-3 * 3.4e-3, full = 1.73e8 * sensor.skin.thickness * area;
    const std::vector<Pressed> pressed =
        simulateByDevice(sensor, Object(HalfSpace{}), std::vector<Press>(20, {{.position = {0, 0, 0.01}}, 0.05, 0.75 * full}));
    for (std::size_t n = 0; n < pressed.size(); ++n) {
      // Depth grows as V = F J: to the thickness where J = 1/0.75.
      const double compliance = 2 - std::exp(-0.5 * 0.05 * static_cast<double>(n) / 0.1);
      if (std::abs(compliance * 0.75 - 1) > 0.01) {
        EXPECT_EQ(pressed[n].reached, compliance * 0.75 < 1) << n;
      }
      if (pressed[n].reached) {
        EXPECT_NEAR(pressed[n].force / (0.75 * full), 1, 0.001);
      }
    }
    EXPECT_FALSE(pressed.back().reached);
  }
}

// A tenth of the load in the dent of all of it, a thousandth, less than float32 tells apart there (carried, or said to be out of reach),
// none.
TEST(RelaxationOnDevice, ASmallLoadInTheDentOfALargeOne) {
  Sensor sensor = support::gridSensor();
  sensor.skin.relaxation = {{0.8, 0.1}};
  for (const double share : {0.1, 1e-3, 1e-9, 0.0}) {
    std::vector<Press> steps(20, {{.position = {0.3e-3, 1e-3, 0.03}}, 0.05, 5.0});
    steps.resize(22, {{.position = {0.3e-3, 1e-3, 0.03}}, 1e-3, 5.0 * share});
    const std::vector<Pressed> pressed = simulateByDevice(sensor, Object(Sphere{0.02}), steps);
    for (std::size_t n = 20; n < pressed.size(); ++n) {
      EXPECT_TRUE(pressed[n].reached || share < 1e-6);
      // Sums of some hundred strains of what the first load left are rounded.
      EXPECT_NEAR(pressed[n].force, 5 * share, 0.001 * 5 * share + 5e-6 * 5) << share;
      EXPECT_LT(0.03 + pressed[n].offset, 0.02 - 50e-6) << share;  // in the dent
    }
  }
}

TEST(RelaxationOnDevice, TaxelsOfOtherLawsFollowTheRelaxedForce) {
  Sensor sensor = support::gridSensor();
  sensor.skin.relaxation = {{0.5, 0.1}, {0.2, 1}};
  const Object sphere(Sphere{0.01});
  std::vector<Press> steps;
  for (const double depth : {0.5e-3, 0.5e-3, 0.7e-3, 0.6e-3}) steps.push_back({{.position = {0, 0, 0.01 - depth}}, 0.1});
  const std::vector<Pressed> pressed = simulateByDevice(sensor, sphere, steps);
  Sensor masked = sensor;
  masked.skin.law = DeformationMask{.normal_contact_stiffness = 1.73e8};
  const std::vector<Pressed> with_mask = simulateByDevice(masked, sphere, steps);
  Sensor moving = sensor;
  const MassSpringDamper law{.normal_contact_stiffness = 1.73e8};
  moving.skin.law = law;
  const std::vector<Pressed> with_masses = simulateByDevice(moving, sphere, steps);
  // Nearly critical and long at rest after 0.1 s: rate 128 /s, decay 65 /s.
  for (std::size_t n = 0; n < steps.size(); ++n) {
    EXPECT_NEAR(with_mask[n].force, pressed[n].force, 1e-5 * pressed[n].force);
    EXPECT_NEAR(with_masses[n].force, pressed[n].force, 0.005 * pressed[n].force);
  }
  EXPECT_LT(pressed[1].force, 0.8 * pressed[0].force);
}

// Dragged far, by pose and under a load: at Coulomb's cone over the pressure that is left.
TEST(RelaxationOnDevice, FrictionIsOfTheRelaxedPressure) {
  constexpr double kMu = 0.6, kLoad = 2, kDepth = 0.5e-3;
  for (const int num_patches : {1, 2}) {
    Sensor sensor = support::gridSensor();
    sensor.patches.resize(static_cast<std::size_t>(num_patches), sensor.patches[0]);
    if (num_patches > 1) sensor.patches[1].X_SP.position = {6 * 3.4e-3, 0, 0};
    sensor.skin.friction = {1e10, kMu};
    sensor.skin.relaxation = {{0.5, 0.2}};
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Box{{0.01, 0.01, 0.01}})}});
    Simulator simulator(model, {.num_instances = 2});
    simulator.setLoads(std::vector<float>{kPoseDriven, static_cast<float>(kLoad)});
    double first = 0;
    for (int n = 0; n < 40; ++n) {
      const Pose X_SO{.position = {20e-6 * n, 0, 0.005 - kDepth}};
      support::setTouches(simulator, {{{0}, {X_SO}}, {{0}, {X_SO}}});
      simulator.step(0.01);
      const auto wrench = simulator.read().ground_truth.contact_wrench;
      if (n == 0) first = -wrench[2];
      EXPECT_NEAR(wrench[8], -kLoad, 0.001 * kLoad);
      if (n > 0) {
        EXPECT_NEAR(wrench[0] / (-kMu * wrench[2]), 1, 0.02) << n;
        EXPECT_NEAR(wrench[6] / (-kMu * wrench[8]), 1, 0.02) << n;
      }
      if (n == 39) {
        EXPECT_LT(-wrench[2], 0.7 * first);
      }
    }
  }
}

// Contacts of another engine bring their own forces: the skin has no say.
TEST(RelaxationOnDevice, ContactsDoNotRelax) {
  Sensor sensor = support::gridSensor();
  sensor.skin.relaxation = {{0.5, 0.1}};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {}});
  Simulator simulator(model, {.outputs = {.penetration_depth = false}, .max_contacts = 1});
  simulator.setContacts(0, std::vector<ContactPoint>{{.position = {1e-3, 1e-3, 0}, .normal_force = 2}});
  for (int n = 0; n < 3; ++n) {
    simulator.step(1);
    EXPECT_NEAR(simulator.read().ground_truth.total_force[0], 2, 1e-5);
  }
}

}  // namespace
}  // namespace taxelsim
