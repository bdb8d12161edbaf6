// Load-driven instances on the device: the load is carried at the offset of the reference, or reported as out of reach.
#include "reference/load.h"
#include "reference/contact.h"
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
// Where force is continuous in the offset, over several tiles: load.comp stops at 1e-6, and the float32 sum of at most 100 tiles, of half a
// rounding (6e-8) each, is off by 10 of them at random.
constexpr double kCarriedOverTiles = 2e-6;
constexpr double kDt = 1e-3;  // s

// Error of the offset, m. Force is convex in depth, so a relative force error r changes the depth by at most r thicknesses; the height of
// the surface is rounded as well.
double offsetSlack(const Sensor& sensor) {
  return kCarried * sensor.skin.thickness + support::kMarginZ;
}

double forceAt(const Sensor& sensor, const std::vector<reference::PlacedObject>& objects, double offset) {
  const auto d = reference::penetrations(reference::surfaceHeights(sensor, reference::movedAlongZ(objects, offset)), sensor.skin.thickness);
  return reference::forceAlongLoad(sensor, reference::computeContact(sensor, d, {}, 0));
}

struct LoadedInstance {
  Touch touch;
  float load;
};

// Simulates the batch and checks every instance: outcome, force, offset, and all stages at the offset of the device.
void runLoads(const Sensor& sensor, const std::vector<Object>& objects, const std::vector<LoadedInstance>& instances, bool is_level) {
  const int num_instances = static_cast<int>(instances.size());
  Simulator simulator = support::makeSimulator(
      sensor, objects, {.num_instances = num_instances, .num_slots = static_cast<int>(instances[0].touch.ids.size())});
  std::vector<Touch> touches;
  std::vector<float> loads;
  for (const LoadedInstance& instance : instances) {
    touches.push_back(instance.touch);
    loads.push_back(instance.load);
  }
  const FrameView frame = support::stepOnce(simulator, touches, kDt, loads);
  support::expectWellFormed(frame, sensor, num_instances);
  for (int i = 0; i < num_instances; ++i) {
    std::string touching;
    for (const int id : touches[i].ids) touching += id == kNoObject ? " -" : " " + objects[id].name;
    SCOPED_TRACE("instance " + std::to_string(i) + ":" + touching);
    const auto placed = touches[i].placed(objects);
    const double offset = frame.ground_truth.load_offset[i];
    const reference::LoadResult expected = reference::findLoad(sensor, placed, loads[i]);
    EXPECT_EQ(frame.ground_truth.load_reached[i], expected.reached ? 1 : 0);
    if (!expected.reached || frame.ground_truth.load_reached[i] == 0) {
      continue;
    }
    // Poses are rounded to float32 after the move, like any pose.
    support::Rounding rounding = support::roundingFor(sensor, placed);
    rounding.margin_z += offsetSlack(sensor);
    const auto envelope = support::frameEnvelope(sensor, touches[i].placed(objects, offset), rounding);
    support::expectMatches(frame, i, sensor, envelope);
    EXPECT_NEAR(-frame.ground_truth.contact_wrench[6 * i + 2], loads[i], kCarried * loads[i] + support::kAbsoluteForce);
    if (is_level) {
      EXPECT_NEAR(offset, expected.offset, offsetSlack(sensor) + rounding.margin_z);
    }
    if (is_level && sensor.psf.normalization == Psf::Normalization::kPerSource) {
      EXPECT_NEAR(frame.ground_truth.total_force[i], loads[i], kCarried * loads[i] + support::kAbsoluteForce);
    }
  }
}

class LoadSeeds : public ::testing::TestWithParam<int> {};

// Over the middle or the border, with one or two objects, solids and meshes (with holes), and loads from 2 to 95 % of the force at full
// depth.
void runRandomLoads(Random& random, const Sensor& sensor, bool is_level,
                    Object (*randomMesh)(Random&, double) = support::randomMeshObject) {
  std::vector<Object> objects;
  for (int n = 0; n < 3; ++n) {
    objects.push_back(random.chance(0.5) ? support::randomSolid(random, 0.02) : randomMesh(random, 0.02));
  }
  std::vector<LoadedInstance> instances;
  for (int i = 0; i < 4; ++i) {
    Touch touch;
    for (int slot = 0; slot < 2; ++slot) {
      touch.ids.push_back(slot > 0 && random.chance(0.5) ? kNoObject : random.integer(0, 2));
      touch.X_SO.push_back(touch.ids.back() == kNoObject ? Pose{} : support::randomContact(random, sensor, objects[touch.ids.back()]));
    }
    // The search starts far above the skin or deep in it.
    const double lift = random.uniform(-0.02, 0.05);
    for (Pose& X_SO : touch.X_SO) {
      X_SO.position[2] += lift;
    }
    const auto placed = touch.placed(objects);
    const double full = forceAt(sensor, placed, reference::findLoad(sensor, placed, 1e9).full_depth);
    if (full > 1e-3) {  // else nothing lies over the skin there
      instances.push_back({touch, static_cast<float>(random.uniform(0.02, 0.95) * full)});
    }
  }
  if (!instances.empty()) {
    runLoads(sensor, objects, instances, is_level);
  }
}

void runRandomLoads(int seed, const support::SensorRange& range, bool is_level,
                    Object (*randomMesh)(Random&, double) = support::randomMeshObject) {
  Random random(static_cast<std::uint64_t>(seed));
  const Sensor sensor = support::randomSensor(random, range);
  runRandomLoads(random, sensor, is_level, randomMesh);
}

TEST_P(LoadSeeds, OnePatch) {
  runRandomLoads(GetParam(), {}, true);
}

TEST_P(LoadSeeds, Polyhedra) {
  runRandomLoads(3000 + GetParam(), {.max_patches = 1 + GetParam() % 2}, true, support::randomPolyhedron);
}

TEST_P(LoadSeeds, SeveralLevelPatches) {
  runRandomLoads(1000 + GetParam(), {.max_rows = 6, .max_cols = 6, .max_patches = 4}, true);
}

TEST_P(LoadSeeds, SeveralTiltedPatches) {
  runRandomLoads(2000 + GetParam(), {.max_rows = 5, .max_cols = 5, .max_patches = 3, .max_patch_tilt = 0.2}, false);
}

// A closed mesh. Loose triangles beyond full depth would leave the skin one by one, so that force does not grow with depth.
Object closedMesh(Random& random, double size) {
  return random.chance(0.5) ? support::randomPolyhedron(random, size)
                            : Object("bumpy sphere", support::icosphere(size / 2, random.integer(0, 3), random.uniform(0, 0.1), random));
}

TEST_P(LoadSeeds, Fingertips) {
  Random random(static_cast<std::uint64_t>(4000 + GetParam()));
  Sensor sensor = GetParam() % 3 == 0   ? support::cylinderFingertip(8e-3, 1.4 + 0.1 * GetParam() / 3, 9, 4, 2.4e-3)
                  : GetParam() % 3 == 1 ? support::sphereFingertip(8e-3, 2, 1.3)
                                        : support::randomTaxels(random, random.integer(10, 40));
  sensor.psf.sigma = 1e-3;
  runRandomLoads(random, sensor, false, closedMesh);
}

INSTANTIATE_TEST_SUITE_P(OnEveryDriver, LoadSeeds, support::seeds(4, 8));

TEST(LoadOnEveryDriver, FlatPunchInClosedForm) {
  const Sensor sensor = support::gridSensor();
  const Object punch(Box{{4 * 3.4e-3, 6 * 3.4e-3, 0.01}});
  Simulator simulator = support::makeSimulator(sensor, {punch});
  const double load = 9.81 * 0.5, depth = load / (1.73e8 * 24 * 3.4e-3 * 3.4e-3);
  for (const double z : {-0.03, 0.0, 0.005, 0.04}) {
    simulator.setObjects(std::vector<int>{0}, std::vector<Pose>{{.position = {0.1e-3, 0.1e-3, z}}});
    simulator.setLoads(std::vector<float>{static_cast<float>(load)});
    const FrameView frame = support::stepOnce(simulator, kDt);
    EXPECT_EQ(frame.ground_truth.load_reached[0], 1);
    EXPECT_NEAR(z + frame.ground_truth.load_offset[0], 0.005 - depth, offsetSlack(sensor) + support::kMarginZ);
    EXPECT_NEAR(frame.ground_truth.total_force[0], load, kCarried * load);
  }
}

TEST(LoadOnEveryDriver, SphereInClosedForm) {
  const double R = 10e-3, depth = 0.8e-3, load = std::numbers::pi * 1.73e8 * depth * depth * (R - depth / 3);
  const Sensor sensor = support::gridSensor({.num_rows = 16, .num_cols = 16, .pitch_x = 1e-3, .pitch_y = 1e-3, .samples_per_taxel = 8});
  Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{R})});
  simulator.setObjects(std::vector<int>{0}, std::vector<Pose>{{.position = {0.2e-3, -0.3e-3, 0.02}}});
  simulator.setLoad(0, static_cast<float>(load));
  const FrameView frame = support::stepOnce(simulator, kDt);
  // The sampled force has an error of 0.15 % at most (worst offset, by an independent program), and dF/F is 2 d(depth)/depth.
  EXPECT_NEAR(0.02 + frame.ground_truth.load_offset[0], R - depth, 0.0015 / 2 * depth + offsetSlack(sensor));
  EXPECT_NEAR(frame.ground_truth.total_force[0], load, kCarried * load);
}

// A weight presses with its weight along its own direction, whatever the normals of the skin. total_force, the trivial reading of the
// load, must differ: else this test would not distinguish the two.
TEST(LoadOnEveryDriver, CurvedSkinCarriesTheLoadAlongItsDirection) {
  const Sensor sensor = support::sphereFingertip(8e-3, 2, 1.3);
  const std::vector<Object> objects{Object(HalfSpace{}), Object(Sphere{15e-3}), Object(Cylinder{5e-3, 40e-3})};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  const std::vector<float> loads{0.05f, 0.5f, 2.0f};
  Simulator simulator(model, {.num_instances = static_cast<int>(objects.size() * loads.size())});
  for (int i = 0; i < simulator.numInstances(); ++i) {
    const bool is_plate = i % 3 == 0;
    const Pose X_SO{{is_plate ? 0 : 1e-3, is_plate ? 0 : 0.5e-3, 0.05}, axisAngle({1, 0, 0}, is_plate ? 0 : std::numbers::pi / 2)};
    simulator.setObjects(i, std::vector<int>{i % 3}, std::vector<Pose>{X_SO});
    simulator.setLoad(i, loads[i / 3]);
  }
  const FrameView frame = support::stepOnce(simulator, kDt);
  for (int i = 0; i < simulator.numInstances(); ++i) {
    SCOPED_TRACE(objects[i % 3].name + " at " + std::to_string(loads[i / 3]) + " N");
    EXPECT_EQ(frame.ground_truth.load_reached[i], 1);
    EXPECT_NEAR(-frame.ground_truth.contact_wrench[6 * i + 2], loads[i / 3], kCarriedOverTiles * loads[i / 3]);
    EXPECT_GT(frame.ground_truth.total_force[i], 1.001 * loads[i / 3]);
  }
}

TEST(LoadOnEveryDriver, OverTheBorderAndAcrossPatches) {
  Sensor sensor = support::gridSensor({.num_rows = 4, .num_cols = 4, .pitch_x = 2e-3, .pitch_y = 2e-3});
  sensor.patches.push_back(sensor.patches[0]);
  sensor.patches[1].name = "second";
  sensor.patches[0].X_SP.position[0] = -4.5e-3;  // a gap of 1 mm between the two
  sensor.patches[1].X_SP.position[0] = 4.5e-3;
  const std::vector<Object> objects{Object(Sphere{6e-3}), Object(Capsule{3e-3, 20e-3})};
  const Quaternion along_x = axisAngle({0, 1, 0}, std::numbers::pi / 2);
  runLoads(sensor, objects,
           {{{{0}, {{.position = {-8.2e-3, 0, 0.01}}}}, 0.5f},         // over the outer border
            {{{0}, {{.position = {0.1e-3, 0.2e-3, 0.01}}}}, 0.7f},     // over the gap
            {{{1}, {{{0.3e-3, -0.2e-3, 0.01}, along_x}}}, 2.0f},       // across both
            {{{0}, {{.position = {-4.5e-3, 4.1e-3, -0.01}}}}, 0.2f}},  // over an edge, starting under the skin
           true);
}

TEST(LoadOnEveryDriver, MeshWithHoles) {
  Random random(9);
  const Sensor sensor = support::gridSensor({.pitch_x = 1.5e-3, .pitch_y = 1.5e-3});
  const std::vector<Object> objects{Object("sheet", support::sheetWithHoles(24, 0.03, 0.1e-3, 0.4, random))};
  runLoads(sensor, objects,
           {{{{0}, {{.position = {0.4e-3, 0.1e-3, 0.003}}}}, 1.0f}, {{{0}, {{{0, 0, 0}, axisAngle({1, 1, 0}, 0.05)}}}, 3.0f}}, true);
}

TEST(LoadOnEveryDriver, ReportsLoadsOutOfReach) {
  const Sensor sensor = support::gridSensor();
  const std::vector<Object> objects{Object(Sphere{3e-3})};
  Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = 4});
  const Pose over{.position = {0, 0, 0.01}}, outside{.position = {0.2, 0, 0.01}};
  const FrameView frame = support::stepOnce(simulator, {{{0}, {over}}, {{0}, {outside}}, {{kNoObject}, {Pose{}}}, {{0}, {over}}}, kDt,
                                            std::vector<float>{1000, 0.1f, 0.1f, 0.1f});
  support::expectWellFormed(frame, sensor, 4);
  EXPECT_EQ(frame.ground_truth.load_reached[0], 0);
  EXPECT_EQ(frame.ground_truth.load_reached[1], 0);
  EXPECT_EQ(frame.ground_truth.load_reached[2], 0);
  EXPECT_EQ(frame.ground_truth.load_reached[3], 1);
  EXPECT_LT(frame.ground_truth.total_force[0], 1000);
  EXPECT_EQ(frame.ground_truth.total_force[1], 0);
  EXPECT_EQ(frame.ground_truth.total_force[2], 0);
  EXPECT_NEAR(frame.ground_truth.total_force[3], 0.1, kCarried * 0.1 + support::kAbsoluteForce);
}

// One grid with a PSF by lists, level and tilted: the search runs in one tile, or over tiles of which there is one.
TEST(LoadOnEveryDriver, OneGridWithPsfLists) {
  Sensor sensor = support::gridSensor({.num_rows = 5, .num_cols = 6});
  sensor.psf.sigma = 3e-3;
  const std::vector<Object> objects{Object(Sphere{8e-3})};
  const Touch over{{0}, {{.position = {1e-3, 2e-3, 0.03}}}}, outside{{0}, {{.position = {0.2, 0, 0.01}}}};
  for (const double tilt : {0.0, 0.15}) {
    sensor.patches[0].X_SP.rotation = axisAngle({1, 2, 0}, tilt);
    runLoads(sensor, objects, {{over, 0.7f}, {outside, 0.5f}, {over, 1.5f}}, tilt == 0);
  }
}

TEST(LoadOnEveryDriver, PoseDrivenInstancesDoNotMove) {
  const std::vector<Object> objects{Object(Sphere{8e-3})};
  const Sensor sensor = support::gridSensor();
  Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = 2});
  const Pose X_SO{.position = {0, 0, 8e-3 - 0.5e-3}};
  FrameView frame = support::stepOnce(simulator, {{{0}, {X_SO}}, {{0}, {X_SO}}}, kDt, std::vector<float>{1.0f, kPoseDriven});
  EXPECT_NE(frame.ground_truth.load_offset[0], 0);
  EXPECT_EQ(frame.ground_truth.load_offset[1], 0);
  const std::vector<std::uint32_t> alone = support::bitsOf(frame, 1, 2);
  simulator.setLoad(0, kPoseDriven);
  frame = support::stepOnce(simulator, kDt);
  EXPECT_EQ(frame.ground_truth.load_offset[0], 0);
  EXPECT_EQ(support::bitsOf(frame, 0, 2), alone);
}

}  // namespace
}  // namespace taxelsim
