// A skin that relaxes on the device against the twin, on random sensors, objects and paths.
#include "reference/contact.h"
#include "reference/load.h"
#include "simulation/comparison.h"
#include "support/cases.h"
#include "support/curved_sensor.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Random;
using support::Touch;

// The load search stops at this relative error, in float32 sums.
constexpr double kCarried = 1e-4;

constexpr double kObjectSize = 0.02;  // m
constexpr int kNumObjects = 3;
constexpr int kNumSteps = 9;
constexpr int kResetStep = 7;
// Median width of the bounds, relative to the force, of frames above kWhisper. Wider bounds would prove little.
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

// State of one instance: bounds of the history of its skin, and the history of the twin.
struct Tracked {
  explicit Tracked(const Sensor& sensor) : bounds(sensor.skin.relaxation), skin(sensor.skin.relaxation) {}

  support::SkinEnvelope bounds;
  reference::SkinHistory skin;
};

// A load that the skin can carry within `dt`, as it has relaxed so far: 2 to 95 % of the force at full depth.
float randomLoad(Random& random, const Sensor& sensor, const std::vector<reference::PlacedObject>& placed, const reference::SkinStep& skin,
                 double dt) {
  const auto deepest = reference::findLoad(sensor, placed, 1e9, skin);
  const auto d =
      reference::penetrations(reference::surfaceHeights(sensor, reference::movedAlongZ(placed, deepest.full_depth)), sensor.skin.thickness);
  const double full = reference::computeContact(sensor, d, {}, dt, skin).total_force;
  return static_cast<float>(full > 1e-3 ? full * random.uniform(0.02, 0.95) : 0.1);
}

// Moves an object a little, or swaps its contact with one elsewhere, where the skin has had time to recover.
void moveOn(Random& random, double thickness, Touch& touch, Touch& elsewhere) {
  if (random.chance(0.4)) {
    std::swap(touch, elsewhere);
    return;
  }
  for (Pose& X_SO : touch.X_SO) {
    if (random.chance(0.2)) continue;
    const Vector3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1) + 1e-3};
    X_SO.rotation = axisAngle(axis, random.uniform(0, 0.05)) * X_SO.rotation;
    for (double& coordinate : X_SO.position) coordinate += random.uniform(-0.4, 0.4) * thickness;
  }
}

support::Rounding roundingOf(const Sensor& sensor, const std::vector<reference::PlacedObject>& placed, bool is_loaded) {
  support::Rounding rounding = support::roundingFor(sensor, placed);
  // A load search rounds the pose once more.
  rounding.margin_z += is_loaded ? support::kMarginZ : 0;
  return rounding;
}

// Expects all stages of one instance inside the bounds of its twin, whose skin then advances by `dt`. Returns the width of the bounds
// relative to the force, if the force exceeds kWhisper.
std::optional<double> expectLikeTwin(const FrameView& frame, int i, const Sensor& sensor,
                                     const std::vector<reference::PlacedObject>& placed, double dt, bool is_loaded, Tracked& twin) {
  const auto envelope = support::frameEnvelope(sensor, placed, roundingOf(sensor, placed, is_loaded), {}, dt, &twin.bounds);
  support::expectMatches(frame, i, sensor, envelope);
  const auto d = reference::penetrations(reference::surfaceHeights(sensor, placed), sensor.skin.thickness);
  twin.skin.advance(dt, reference::computeContact(sensor, d, {}, dt, twin.skin.step(dt)).strain);
  if (envelope.total_high <= kWhisper) return std::nullopt;
  return (envelope.total_high - envelope.total_low) / envelope.total_high;
}

void expectLoad(const FrameView& frame, int i, const Sensor& sensor, double load, const reference::LoadResult& expected,
                const std::vector<reference::PlacedObject>& placed) {
  EXPECT_EQ(frame.ground_truth.load_reached[i], expected.reached ? 1 : 0);
  if (!expected.reached) return;
  EXPECT_NEAR(-frame.ground_truth.contact_wrench[6 * i + 2], load, kCarried * load + support::kAbsoluteForce);
  EXPECT_NEAR(frame.ground_truth.load_offset[i], expected.offset,
              kCarried * sensor.skin.thickness + 2 * roundingOf(sensor, placed, true).margin_z);
}

void runPath(const PathKind& kind, int seed) {
  Random random(static_cast<std::uint64_t>(seed));
  Sensor sensor = kind.curved >= 0 ? support::curvedSensor(random, kind.curved) : support::randomSensor(random, kind.sensor);
  sensor.samples_per_taxel = random.integer(1, 5);
  sensor.skin.relaxation = randomTerms(random, 1 + seed % kMaxRelaxationTerms);
  const std::vector<Object> objects = support::randomObjects(random, kNumObjects, kObjectSize, kind.solid_share, kind.all_convex);
  constexpr int kNumInstances = 3;
  std::vector<Touch> touches(kNumInstances), elsewhere(kNumInstances);
  for (std::vector<Touch>* places : {&touches, &elsewhere}) {
    for (Touch& touch : *places) {
      for (int slot = 0; slot < kind.num_slots; ++slot) {
        touch.ids.push_back(random.integer(0, kNumObjects - 1));
        const Object& object = objects[touch.ids.back()];
        touch.X_SO.push_back(kind.curved >= 0 ? support::randomContactOnTaxel(random, sensor, object)
                                              : support::randomContact(random, sensor, object));
      }
    }
  }
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects, .contact_workgroup = support::randomWorkgroup(random)});
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
      loads[i] = randomLoad(random, sensor, placed, skin, dt);
      expected[i] = reference::findLoad(sensor, placed, loads[i], skin);
    }
    const FrameView frame = support::stepOnce(simulator, touches, dt, loads);
    support::expectWellFormed(frame, sensor, kNumInstances);
    const auto& forces = frame.ground_truth.tactile_normal_force;
    EXPECT_GE(*std::min_element(forces.begin(), forces.end()), 0);
    for (int i = 0; i < kNumInstances; ++i) {
      SCOPED_TRACE("step " + std::to_string(step) + ", instance " + std::to_string(i));
      const std::optional<double> width = expectLikeTwin(frame, i, sensor, touches[i].placed(objects, frame.ground_truth.load_offset[i]),
                                                         dt, !std::isnan(loads[i]), tracked[i]);
      if (width) looseness.push_back(*width);
      if (!std::isnan(loads[i]) && kind.is_level) expectLoad(frame, i, sensor, loads[i], expected[i], touches[i].placed(objects));
    }
    for (std::size_t i = 0; i < touches.size(); ++i) moveOn(random, sensor.skin.thickness, touches[i], elsewhere[i]);
  }
  support::expectMedianAtMost(looseness, kLoosest);
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

TEST_P(RelaxationTwinSeeds, TaxelLists) {
  runPath({.sensor = {}, .curved = GetParam() % 3, .num_slots = 1 + GetParam() / 6}, 5000 + GetParam());
}

// 1024 x 1024 samples over many tiles.
TEST(RelaxationOnDevice, LargestSensorMatchesTheTwin) {
  Sensor sensor = support::gridSensor({.num_rows = 128, .num_cols = 128, .pitch_x = 0.5e-3, .pitch_y = 0.5e-3, .samples_per_taxel = 4});
  sensor.skin.relaxation = {{0.5, 1e-3}};
  Tracked tracked(sensor);
  const std::vector<Object> objects{Object(Sphere{0.03})};
  Simulator simulator = support::makeSimulator(sensor, objects);
  for (const double depth : {1e-3, 0.8e-3, 1.2e-3}) {
    const Touch touch{{0}, {{.position = {1e-3, 2e-3, 0.03 - depth}}}};
    support::expectMatches(support::stepOnce(simulator, {touch}, 1e-3), 0, sensor,
                           support::frameEnvelope(sensor, touch.placed(objects), support::roundingFor(sensor, touch.placed(objects)), {},
                                                  1e-3, &tracked.bounds));
  }
}

INSTANTIATE_TEST_SUITE_P(OnEveryDriver, RelaxationTwinSeeds, support::seeds(3, 6));

}  // namespace
}  // namespace taxelsim
