// Each fast path against the plain path: the same bits, or the frame of the twin where another formula computes the same surface.
#include "simulation/comparison.h"
#include "support/input_error.h"
#include "support/plain.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Plain;
using support::Random;
using support::Touch;

using Bits = std::vector<std::uint32_t>;

struct Scene {
  Sensor sensor;
  std::vector<Object> objects{};
  std::vector<std::vector<Touch>> steps{};  // (steps x instances)
  std::vector<float> loads{};
  int contact_workgroup = 0;
  OutputOptions outputs{};
};

// The bits of all instances in all steps, without the fast paths `plain`.
std::vector<Bits> bitsOf(const Scene& scene, const std::string& plain) {
  const Plain without(plain);
  const Model model(support::sharedDevice(),
                    {.sensor = scene.sensor, .objects = scene.objects, .contact_workgroup = scene.contact_workgroup});
  const int num_instances = static_cast<int>(scene.steps[0].size()), num_slots = static_cast<int>(scene.steps[0][0].ids.size());
  Simulator simulator(model, {.num_instances = num_instances, .num_slots = num_slots, .outputs = scene.outputs});
  std::vector<Bits> all;
  for (const std::vector<Touch>& touches : scene.steps) {
    const std::vector<Bits> now = support::bitsOfAll(support::stepOnce(simulator, touches, 1e-3, scene.loads), num_instances);
    all.insert(all.end(), now.begin(), now.end());
  }
  return all;
}

// A sensor whose contacts can be drawn: springs instead of its law.
Sensor withSprings(const Sensor& sensor) {
  Sensor springs = sensor;
  springs.skin = {.thickness = sensor.skin.thickness, .law = Winkler{1.73e8, 1, 0}};
  return springs;
}

// Many tiles, most without contact, and a mesh of more groups than one batch culls.
Scene wideScene(int num_patches) {
  Random random(31);
  Scene scene{support::gridSensor({.num_rows = 48, .num_cols = 48, .samples_per_taxel = 4})};
  if (num_patches > 1) {
    scene.sensor = support::gridSensor({.num_rows = 8, .num_cols = 8, .samples_per_taxel = 4});
    for (int n = 1; n < num_patches; ++n) {
      GridPatch patch = scene.sensor.patches[0];
      patch.name = "patch " + std::to_string(n);
      patch.X_SP.position = {0.04 * n, 0, 0};
      scene.sensor.patches.push_back(patch);
    }
  }
  constexpr int kSubdivisions = 6;  // 81,920 triangles: 320 groups
  scene.objects.emplace_back("bumpy sphere", support::icosphere(0.02, kSubdivisions, 0.01, random));
  scene.objects.push_back(support::randomMeshObject(random, 0.02));
  scene.steps.resize(1);
  for (int i = 0; i < 5; ++i) scene.steps[0].push_back({{i % 2}, {support::randomContact(random, scene.sensor, scene.objects[i % 2])}});
  return scene;
}

TEST(FasterPathsOnEveryDriver, ChangeNoBit) {
  for (const int num_patches : {1, 4}) {
    const Scene scene = wideScene(num_patches);
    const auto expected = bitsOf(scene, "");
    for (const char* name : {"untouched", "lockstep", "alone", "untouched,lockstep,alone"}) {
      EXPECT_EQ(bitsOf(scene, name), expected) << name << ", " << num_patches << " patches";
    }
  }
}

// Solids, polyhedra and meshes in one model, some instances without an object, over two steps. Only a batch of this size is divided by
// kinds.
void expectKindsDoNotShow(const Sensor& sensor) {
  constexpr int kNumInstances = 256;
  const Sensor springs = withSprings(sensor);
  Random random(13);
  const std::vector<Object> objects{Object("cylinder", Cylinder{.radius = 8e-3, .length = 30e-3}), support::randomPolyhedron(random, 0.02),
                                    Object("bumps", support::icosphere(10e-3, 4, 0.02, random)), Object("ball", Sphere{.radius = 6e-3})};
  std::vector<std::vector<Touch>> steps(2);
  for (int i = 0; i < kNumInstances; ++i) {
    const int id = i % 4;
    Touch touch{{i % 9 == 4 ? kNoObject : id}, {support::randomContact(random, springs, objects[id])}};
    steps[0].push_back(touch);
    touch.ids[0] = i % 9 == 5 ? kNoObject : (id + i % 7 / 6) % 4;  // some leave, some change their object
    touch.X_SO[0].position[0] += 0.1e-3;
    steps[1].push_back(touch);
  }
  const Scene scene{sensor, objects, steps};
  EXPECT_EQ(bitsOf(scene, ""), bitsOf(scene, "kinds"));
}

TEST(FasterPathsOnEveryDriver, KindsOfObjectsChangeNoBit) {
  Sensor sensor = support::gridSensor();
  sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  expectKindsDoNotShow(sensor);
  support::addPatch(sensor, {.position = {0.03, 0, 0}});
  sensor.skin.friction = {};
  expectKindsDoNotShow(sensor);
  sensor = support::gridSensor({.num_rows = 5, .num_cols = 6, .samples_per_taxel = 2});
  sensor.depth_sampling = DepthSampling::kArea;
  expectKindsDoNotShow(sensor);
}

// Balls of 20,480 triangles that reach as far below the skin as above it, so that a workgroup can take few of them before it leaves its
// other tiles to the second dispatch. The objects creep, so that some steps use candidates.
void expectSequencesDoNotShow(const Sensor& sensor, int num_instances) {
  constexpr double kRadius = 5e-3;
  Random random(29);
  const std::vector<Object> objects{Object("ball", support::icosphere(kRadius, 5, 0.01, random)), support::randomMeshObject(random, 0.02)};
  std::vector<std::vector<Touch>> steps(4);
  for (int i = 0; i < num_instances; ++i) {
    Touch touch{{i % 5 == 4}, {{{random.uniform(-8e-3, 8e-3), random.uniform(-8e-3, 8e-3), i % 3 == 0 ? 0.9 * kRadius : 0}}}};
    for (std::vector<Touch>& step : steps) {
      step.push_back(touch);
      touch.X_SO[0].position[0] += 0.01e-3;
    }
  }
  const Scene scene{sensor, objects, steps};
  EXPECT_EQ(bitsOf(scene, ""), bitsOf(scene, "sequences,candidates"));
}

TEST(FasterPathsOnEveryDriver, SequencesOfTilesChangeNoBit) {
  Sensor sensor = support::gridSensor();
  expectSequencesDoNotShow(sensor, 256);
  support::addPatch(sensor, {.position = {0.01, 0, 0}});
  expectSequencesDoNotShow(sensor, 128);
}

// Covers every pass with barriers for two steps; on a software driver each workgroup is one vector.
void expectLockstepDoesNotShow(const Sensor& sensor) {
  constexpr int kNumInstances = 6;
  const Sensor springs = withSprings(sensor);
  Random random(5);
  const std::vector<Object> objects{support::randomMeshObject(random, 0.02), support::randomSolid(random, 0.02),
                                    Object("sphere", support::icosphere(0.02, 4, 0.01, random))};
  std::vector<std::vector<Touch>> steps(2);
  std::vector<float> loads;
  for (int i = 0; i < kNumInstances; ++i) {
    Touch touch{{i % 3, (i + 1) % 3}, {}};
    for (const int id : touch.ids) touch.X_SO.push_back(support::randomContact(random, springs, objects[id]));
    steps[0].push_back(touch);
    for (Pose& X_SO : touch.X_SO) X_SO.position[0] += 0.1e-3;
    steps[1].push_back(touch);
    loads.push_back(i % 2 == 1 ? 1.5f : kPoseDriven);
  }
  const Scene scene{sensor, objects, steps, loads, 8, {.tactile_jacobian = true, .clean_tactile_jacobian = true}};
  EXPECT_EQ(bitsOf(scene, ""), bitsOf(scene, "lockstep"));
}

TEST(FasterPathsOnEveryDriver, LockstepChangesNoBit) {
  Sensor sensor = support::gridSensor();
  sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  sensor.skin.relaxation = {{.fraction = 0.4, .time = 0.01}};
  expectLockstepDoesNotShow(sensor);
  sensor.depth_sampling = DepthSampling::kArea;
  expectLockstepDoesNotShow(sensor);
  Sensor layer = support::gridSensor({.num_rows = 5, .num_cols = 6, .samples_per_taxel = 2});
  layer.skin.law = ElasticLayer{.elastic_modulus = 1e6, .poisson_ratio = 0.49};
  expectLockstepDoesNotShow(layer);
}

// A cylinder across the array slides back and forth over several taxels: those next to it are skipped in some steps, and what they kept
// from the step before must not count in the next one.
void expectSkippedTaxelsForget(const Sensor& sensor) {
  constexpr double kRadius = 8e-3, kSlide = 5e-3, kHalf = 0.39, kLie = 0.7071067811865476;  // m; half of the yaw, rad; sine of 45 degrees
  const std::vector<Object> objects{Object("cylinder", Cylinder{.radius = kRadius, .length = 60e-3})};
  std::vector<std::vector<Touch>> steps;
  for (const double at : {-0.5, 0.5, -0.4, 0.1, 0.6, -0.5}) {
    const Quaternion lying{kLie * std::cos(kHalf), kLie * std::cos(kHalf), kLie * std::sin(kHalf), kLie * std::sin(kHalf)};
    steps.push_back({{{0}, {{{at * kSlide, 0, kRadius - 0.6e-3}, lying}}}});
  }
  const Scene scene{sensor, objects, steps};
  EXPECT_EQ(bitsOf(scene, ""), bitsOf(scene, "untouched"));
}

TEST(FasterPathsOnEveryDriver, SkippedTaxelsForgetTheirStates) {
  Sensor sensor = support::gridSensor({.num_rows = 8, .num_cols = 8, .samples_per_taxel = 4, .law = {1.73e8, 1, 1e5}});
  expectSkippedTaxelsForget(sensor);
  sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  expectSkippedTaxelsForget(sensor);
}

// Objects that jump or disappear after every reset: old contents of the buffers change no bit.
void expectNothingIsLeft(const Sensor& sensor, bool with_loads) {
  constexpr int kNumInstances = 4, kNumSteps = 6;
  const Sensor springs = withSprings(sensor);
  Random random(11);
  const std::vector<Object> objects{Object("ball", Sphere{.radius = 6e-3}), Object("bumps", support::icosphere(8e-3, 2, 0.02, random))};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  Simulator kept(model, {.num_instances = kNumInstances});
  const auto bitsAfter = [&](Simulator& simulator, const std::vector<Touch>& touches) {
    support::setTouches(simulator, touches);
    for (int i = 0; i < kNumInstances; ++i) {
      simulator.reset(i, 0);
      if (with_loads && i % 2 == 1) simulator.setLoad(i, 0.7f);
    }
    return support::bitsOfAll(support::stepOnce(simulator, 1e-3), kNumInstances);
  };
  for (int step = 0; step < kNumSteps; ++step) {
    std::vector<Touch> touches;
    for (int i = 0; i < kNumInstances; ++i) {
      const int id = (i + step) % 2;
      const Pose X_SO = support::randomContact(random, springs, objects[id]);
      touches.push_back({{(i + step) % 5 == 4 ? kNoObject : id}, {X_SO}});
    }
    Simulator fresh(model, {.num_instances = kNumInstances});
    EXPECT_EQ(bitsAfter(kept, touches), bitsAfter(fresh, touches)) << "step " << step;
  }
}

TEST(FasterPathsOnEveryDriver, NoStateRemainsAfterReset) {
  Sensor sensor = support::gridSensor({.num_rows = 9, .num_cols = 9});
  expectNothingIsLeft(sensor, true);
  sensor.frame_rate = 1000;
  expectNothingIsLeft(sensor, false);
}

// So wide that a bit of the elastic layer's sources covers two strips of nodes.
TEST(FasterPathsOnEveryDriver, NoStateRemainsOnAWideElasticLayer) {
  Sensor layer = support::gridSensor({.num_rows = 3, .num_cols = 17, .samples_per_taxel = 8, .thickness = 1e-3});
  layer.skin.law = ElasticLayer{.elastic_modulus = 1e6, .poisson_ratio = 0.4};
  expectNothingIsLeft(layer, false);
}

TEST(FasterPathsOnEveryDriver, NoStateRemainsOnManyTiles) {
  Sensor sensor = support::gridSensor({.num_rows = 48, .num_cols = 48, .samples_per_taxel = 4, .law = {1.73e8, 1, 1e5}});
  sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  expectNothingIsLeft(sensor, true);
  sensor.skin = {.thickness = sensor.skin.thickness, .law = DeformationMask{}};
  expectNothingIsLeft(sensor, false);
}

TEST(FasterPathsOnEveryDriver, PolyhedronAsTrianglesMatchesTheTwin) {
  const Plain without("polyhedra");
  Random random(7);
  const Sensor sensor = support::gridSensor();
  const std::vector<Object> objects{support::randomPolyhedron(random, 0.02)};
  const Touch touch{{0}, {support::randomContact(random, sensor, objects[0])}};
  Simulator simulator = support::makeSimulator(sensor, objects);
  support::setTouches(simulator, {touch});
  simulator.step(1e-3);
  const auto placed = touch.placed(objects);
  support::expectMatches(simulator.read(), 0, sensor, support::frameEnvelope(sensor, placed, support::roundingFor(sensor, placed)));
}

TEST(FasterPathsOnEveryDriver, RejectsAnUnknownName) {
  const Plain without("kinds,pears");
  EXPECT_EQ(support::inputError([] { Model(support::sharedDevice(), {.sensor = support::gridSensor()}); }),
            "TAXELSIM_PLAIN: \"pears\" is not allowed: polyhedra, kinds, untouched, candidates, lockstep, alone, sequences, "
            "threads, servo, all");
}

}  // namespace
}  // namespace taxelsim
