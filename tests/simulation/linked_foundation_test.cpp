// The law `pasternak` on several patches and curved arrays: against the grid, the twin and closed forms, under loads, in batches.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "reference/pasternak.h"
#include "sensor/pasternak.h"
#include "simulation/comparison.h"
#include "simulation/foundation_law.h"
#include "simulation/linked_sensors.h"
#include "support/curved_sensor.h"

namespace taxelsim {
namespace {

using support::Random;
using support::Touch;

constexpr double kPi = std::numbers::pi;
constexpr double kShear = kStiffness * kDecay * kDecay;

Sensor cylinder(int iterations = 0) {
  return onFoundation(support::cylinderFingertip(8e-3, 0.6, 5, 3, 2.4e-3), 3, iterations);
}
Sensor sphere(int iterations = 0) {
  return onFoundation(support::sphereFingertip(8e-3, 2, 0.6), 3, iterations);
}

// Of one object in one pose.
double forceOf(const Sensor& sensor, const Object& object, const Pose& X_SO) {
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {object}});
  Simulator simulator(model, {});
  return step(simulator, {{{0}, {X_SO}}}).ground_truth.total_force[0];
}

// A list has the links of its grid.
TEST(LinkedFoundationOnEveryDriver, FlatListEqualsItsGrid) {
  // Active nodes end at least a decay length away, those of the grid two: the surface there is not quite exponential. Measured: 7e-4.
  constexpr double kMargin = 1e-3;  // of the force
  Random random(7);
  const Sensor grid = onFoundation(support::gridSensor({.num_rows = 4, .num_cols = 5, .pitch_x = 2e-3, .pitch_y = 3e-3}), 3, kManySweeps);
  Sensor list = grid;
  list.patches.clear();
  for (const Vector3& p : taxelPositions(grid)) list.patches.push_back(taxelPatch("t", p, {0, 0, 1}, grid.patches[0].pitch));
  const std::vector<Object> objects{support::icosphere(0.008, 3, 0.05, random), Object(Sphere{6e-3}), Object(Cylinder{1.07e-3, 0.01}),
                                    Object(Box{{0.004, 0.01, 0.01}})};
  std::vector<Touch> touches;
  Sensor springs = grid;
  springs.skin.law = Winkler{.normal_contact_stiffness = kStiffness};
  for (int i = 0; i < 12; ++i)
    touches.push_back({{i % 4}, {support::randomContact(random, springs, objects[static_cast<std::size_t>(i % 4)])}});
  const Model grid_model(support::sharedDevice(), {.sensor = grid, .objects = objects});
  const Model list_model(support::sharedDevice(), {.sensor = list, .objects = objects});
  Simulator on_grid(grid_model, {.num_instances = 12}), on_list(list_model, {.num_instances = 12});
  const FrameView one = step(on_grid, touches), other = step(on_list, touches);
  double worst = 0;
  for (std::size_t i = 0; i < 12; ++i) {
    SCOPED_TRACE(i);
    const double force = one.ground_truth.total_force[i];
    EXPECT_NEAR(other.ground_truth.total_force[i], force, kMargin * force + support::kAbsoluteForce);
    if (force > 0) worst = std::max(worst, std::abs(other.ground_truth.total_force[i] / force - 1));
    for (std::size_t t = 0; t < 20; ++t) {
      EXPECT_NEAR(other.ground_truth.tactile_normal_force[20 * i + t], one.ground_truth.tactile_normal_force[20 * i + t],
                  kMargin * force + support::kAbsoluteForce);
    }
  }
  RecordProperty("worst", std::to_string(worst));
}

double deepestOf(const reference::LayerContact& contact) {
  return *std::max_element(contact.overlap.begin(), contact.overlap.end());
}

void expectLikeTwin(const FrameView& frame, std::size_t i, const Sensor& sensor, const reference::LayerContact& twin) {
  // The surface at the end of the active taxels, and links that the twin knows to 1 / 240 of a side.
  constexpr double kLinks = 2e-3;   // of the force
  constexpr double kExtent = 0.02;  // m: from S's origin to the farthest node
  const double slack = (2 * support::kMarginZ / deepestOf(twin) + kLinks) * twin.total_force + support::kAbsoluteForce;
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  for (std::size_t t = 0; t < num_taxels; ++t) {
    EXPECT_NEAR(frame.ground_truth.tactile_normal_force[i * num_taxels + t], twin.taxel_force[t], slack) << "taxel " << t;
    EXPECT_NEAR(frame.ground_truth.penetration_depth[i * num_taxels + t], twin.mean_penetration[t], 2 * support::kMarginZ) << t;
  }
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_NEAR(frame.ground_truth.contact_wrench[6 * i + k], twin.wrench[k], k < 3 ? slack : slack * kExtent);
  EXPECT_NEAR(frame.ground_truth.over_penetration[i], twin.over_penetration, 2.0 / numTaxels(sensor));
}

void expectRandomContactsLikeTwin(const Sensor& sensor, int seed) {
  constexpr int kInstances = 9;
  Random random(seed);
  const std::vector<Object> objects{Sphere{0.006}, support::icosphere(0.008, 3, 0.05, random), Box{{0.004, 0.01, 0.01}}};
  std::vector<Touch> touches;
  for (int i = 0; i < kInstances; ++i) {
    const Object& object = objects[static_cast<std::size_t>(i % 3)];
    const Pose& X_SP = sensor.patches[static_cast<std::size_t>(random.integer(0, static_cast<int>(sensor.patches.size()) - 1))].X_SP;
    Sensor lone = sensor;
    lone.patches = {sensor.patches.front()};
    lone.patches[0].X_SP = {};
    lone.skin.law = Winkler{.normal_contact_stiffness = kStiffness};
    const Pose on_patch = support::poseAtDepth(lone, object, random.tilt(0.5), random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3),
                                               random.uniform(0.1e-3, 1.2e-3));
    touches.push_back({{i % 3}, {X_SP * on_patch}});
  }
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  Simulator simulator(model, {.num_instances = kInstances});
  const FrameView frame = step(simulator, touches);
  support::expectWellFormed(frame, sensor, kInstances);
  int num_touching = 0;
  for (std::size_t i = 0; i < kInstances; ++i) {
    SCOPED_TRACE("instance " + std::to_string(i) + ": object " + std::to_string(touches[i].ids[0]));
    const reference::LayerContact twin = reference::foundationContact(sensor, touches[i].placed(objects));
    num_touching += twin.total_force > 0 ? 1 : 0;
    if (twin.total_force > 0) {
      expectLikeTwin(frame, i, sensor, twin);
    } else {
      EXPECT_EQ(frame.ground_truth.total_force[i], 0);
    }
  }
  EXPECT_GE(num_touching, kInstances / 2);
}

struct Arrays : ::testing::TestWithParam<int> {
  static Sensor sensorOf(int kind, int iterations) {
    return kind == 0 ? cylinder(iterations) : kind == 1 ? sphere(iterations) : threeGrids(iterations);
  }
};

TEST_P(Arrays, RandomContactsMatchTheTwin) {
  expectRandomContactsLikeTwin(sensorOf(GetParam(), kManySweeps), 5 + GetParam());
}

// Taxels of all sizes on an ellipsoid, with gaps and overlaps; the smallest nodes need more sweeps.
TEST(LinkedFoundation, RandomTaxelsMatchTheTwin) {
  constexpr int kSweepsOfSmallNodes = 200;
  Random random(3);
  expectRandomContactsLikeTwin(onFoundation(support::randomTaxels(random, 24), 1, kSweepsOfSmallNodes), 9);
}

TEST_P(Arrays, TheSkinCarriesTheLoad) {
  constexpr double kCarried = 2e-6;     // of the load, load_test.cpp
  constexpr double kQuantum = 0x1p-32;  // m: heights of the tile count from the bottom of the skin, 2 mm, and move in steps
  constexpr int kInstances = 4;
  const Sensor sensor = sensorOf(GetParam(), kManySweeps);
  Random random(15 + GetParam());
  const std::vector<Object> objects{Sphere{0.006}, Box{{30e-3, 30e-3, 5e-3}}};
  std::vector<Touch> touches;
  std::vector<float> loads;
  for (int i = 0; i < kInstances; ++i) {
    touches.push_back({{i % 2}, {{{random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3), 0.03}, {1, 0, 0, 0}}}});
    loads.push_back(static_cast<float>(random.uniform(0.2, 3)));
  }
  loads[2] = kPoseDriven;
  touches[2].X_SO[0].position[2] = 5.8e-3;
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  Simulator simulator(model, {.num_instances = kInstances});
  simulator.setLoads(loads);
  const FrameView frame = step(simulator, touches);
  for (std::size_t i = 0; i < kInstances; ++i) {
    SCOPED_TRACE("instance " + std::to_string(i));
    if (i == 2) {
      expectLikeTwin(frame, i, sensor, reference::foundationContact(sensor, touches[i].placed(objects)));
      continue;
    }
    EXPECT_EQ(frame.ground_truth.load_reached[i], 1);
    const reference::LayerContact twin = reference::loadedFoundationContact(sensor, touches[i].placed(objects), loads[i]);
    EXPECT_TRUE(twin.load_reached);
    EXPECT_NEAR(-frame.ground_truth.contact_wrench[6 * i + 2], loads[i], (kCarried + kQuantum / deepestOf(twin)) * loads[i]);
    EXPECT_NEAR(frame.ground_truth.load_offset[i], twin.offset, 2e-3 * deepestOf(twin) + 2 * support::kMarginZ);
  }
}

std::string nameOf(const ::testing::TestParamInfo<int>& info) {
  return info.param == 0 ? "cylinder" : info.param == 1 ? "sphere" : "grids";
}
INSTANTIATE_TEST_SUITE_P(LinkedFoundation, Arrays, ::testing::Range(0, 3), nameOf);

// The default number of sweeps is that of the grid: sensor/pasternak.h.
TEST(LinkedFoundation, DefaultSweepsConverge) {
  constexpr double kError = 8e-3;  // of the force
  for (const bool is_sphere : {false, true}) {
    const Pose pose{{0.7e-3, -0.4e-3, 5.6e-3}, {1, 0, 0, 0}};
    const double found = forceOf(is_sphere ? sphere() : cylinder(), Sphere{6e-3}, pose);
    const double converged = forceOf(is_sphere ? sphere(kManySweeps) : cylinder(kManySweeps), Sphere{6e-3}, pose);
    EXPECT_NEAR(found / converged, 1, kError);
    RecordProperty(is_sphere ? "sphere" : "cylinder", std::to_string(found / converged));
  }
}

TEST(LinkedFoundation, LoadsBeyondTheSkinAreOutOfReach) {
  const Model model(support::sharedDevice(), {.sensor = cylinder(), .objects = {Sphere{2e-3}}});
  Simulator simulator(model, {.num_instances = 3});
  simulator.setLoads(std::vector<float>{1000, 1, 0});
  const FrameView frame = step(
      simulator, {{{0}, {{{0, 0, 0.02}, {1, 0, 0, 0}}}}, {{0}, {{{0.5, 0, 0.02}, {1, 0, 0, 0}}}}, {{0}, {{{0, 0, 0.02}, {1, 0, 0, 0}}}}});
  EXPECT_FALSE(frame.ground_truth.load_reached[0]);
  EXPECT_FALSE(frame.ground_truth.load_reached[1]);
  EXPECT_TRUE(frame.ground_truth.load_reached[2]);
  EXPECT_EQ(frame.ground_truth.total_force[2], 0);
}

// A plane along a cylinder, per length: inside of the contact of half-width a the depth is delta - s^2 / (2 R), outside it decays as
// exp(-s / l). Taxels are flat: those of 0.4 mm lie up to pitch^2 / (8 R) = 1.0 um above the cylinder, on average a third of it.
TEST(LinkedFoundation, PlaneOnACylinderInClosedForm) {
  constexpr double kRadius = 20e-3, kWidth = 1e-3, kPitch = 0.4e-3, kError = 0.015;
  const double depth = kWidth * kWidth / (2 * kRadius) + kWidth * kDecay / kRadius;
  const double force = 2 * kStiffness * (depth * kWidth - std::pow(kWidth, 3) / (6 * kRadius)) + 2 * kShear * kWidth / kRadius;  // N/m
  constexpr int kAround = 13, kAlong = 14, kEnd = 5;  // rows at the ends, where the skin beyond is drawn down, too
  const Sensor sensor = onFoundation(support::cylinderFingertip(kRadius, (kAround - 1) / 2 * kPitch / kRadius, kAround, kAlong, kPitch), 2);
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(HalfSpace{})}});
  Simulator simulator(model, {});
  const FrameView frame = step(simulator, {{{0}, {{{0, 0, -depth}, {1, 0, 0, 0}}}}});
  double sum = 0;
  for (int i = 0; i < kAround; ++i) {
    for (int j = kEnd; j < kAlong - kEnd; ++j) sum += frame.ground_truth.tactile_normal_force[static_cast<std::size_t>(i * kAlong + j)];
  }
  RecordProperty("ratio", std::to_string(sum / ((kAlong - 2 * kEnd) * kPitch) / force));
  EXPECT_NEAR(sum / ((kAlong - 2 * kEnd) * kPitch) / force, 1, kError);
}

// A plane on a sphere is a sphere on a plane. Taxels of 0.7 mm lie some pitch^2 / (12 R) = 1 um above the sphere, have gaps and overlap.
TEST(LinkedFoundation, PlaneOnASphereInClosedForm) {
  constexpr double kRadius = 40e-3, a = 2e-3, kError = 0.04;
  const double depth = a * a / (2 * kRadius) + a * kDecay / kRadius / besselRatio(a / kDecay);
  const double force = kPi * kStiffness * (depth * a * a - std::pow(a, 4) / (4 * kRadius)) + 2 * kPi * kShear * a * a / kRadius;
  const Sensor sensor = onFoundation(support::sphereFingertip(kRadius, 6, 0.11), 1);
  const double found = forceOf(sensor, HalfSpace{}, {{0, 0, -depth}, {1, 0, 0, 0}});
  RecordProperty("ratio", std::to_string(found / force));
  EXPECT_NEAR(found / force, 1, kError);
}

// On a cylinder of large radius a pin has the force that it has on a plane, and its closed form, on a seam as in the middle of a taxel.
TEST(LinkedFoundation, LargeRadiusApproachesThePlane) {
  constexpr double kRadius = 1, kPitch = 2.4e-3, kPin = 1e-3, kLength = 10e-3, kDepth = 1e-3, kForm = 0.05;
  // Sag of the contact and of the taxels over the depth; force is linear in depth.
  constexpr double kSag = (kPin * kPin + kPitch * kPitch / 4) / (2 * kRadius) / kDepth;
  const Sensor bent = onFoundation(support::cylinderFingertip(kRadius, 2 * kPitch / kRadius, 5, 5, kPitch), 3, kManySweeps);
  Sensor flat = bent;
  for (GridPatch& patch : flat.patches) patch.X_SP = {{patch.X_SP.position[0], patch.X_SP.position[1], 0}, {1, 0, 0, 0}};
  const double form = kDepth * pasternakPunchStiffness(std::get<Pasternak>(bent.skin.law), kPin);
  for (const double x : {0.0, 0.31e-3, kPitch / 2, 0.9e-3}) {
    const Pose pose{{x, 0.17e-3, kLength / 2 - kDepth}, {1, 0, 0, 0}};
    const double on_bent = forceOf(bent, Cylinder{kPin, kLength}, pose), on_flat = forceOf(flat, Cylinder{kPin, kLength}, pose);
    EXPECT_NEAR(on_bent / on_flat, 1, 2 * kSag) << x;
    EXPECT_NEAR(on_bent / form, 1, kForm) << x;
  }
}

// A tube pressed evenly on a closed ring of taxels: the surface is nowhere bent along the skin, so that the springs carry all, except at
// the two ends of the ring. The skin has no end around the ring.
TEST(LinkedFoundation, EvenPressOnAClosedRing) {
  constexpr int kAround = 24, kAlong = 4, kFacets = 720;
  constexpr double kRadius = 5e-3, kDepth = 0.3e-3, kPitch = 2.4e-3, kTube = kRadius - kDepth;
  constexpr double kFlat = 1e-3;  // of the depth: the facets of the tube, and the float32 sums
  const Sensor sensor =
      onFoundation(support::cylinderFingertip(kRadius, kPi * (1 - 1.0 / kAround), kAround, kAlong, kPitch), 3, kManySweeps);
  Mesh tube;
  for (int n = 0; n < kFacets; ++n) {
    const double angle = 2 * kPi * n / kFacets;
    for (const float y : {-0.02f, 0.02f})
      tube.vertices.push_back({static_cast<float>(kTube * std::sin(angle)), y, static_cast<float>(kTube * std::cos(angle) - kRadius)});
    const auto at = [](int k) { return static_cast<std::uint32_t>(k % (2 * kFacets)); };
    tube.triangles.push_back({at(2 * n), at(2 * n + 1), at(2 * n + 3)});
    tube.triangles.push_back({at(2 * n), at(2 * n + 3), at(2 * n + 2)});
  }
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object("tube", tube)}});
  Simulator simulator(model, {});
  const FrameView frame = step(simulator, {{{0}, {{{0, 0, 0}, {1, 0, 0, 0}}}}});
  const int per_side = 3 * pasternakRefinement(sensor);
  const double width = sensor.patches[0].pitch[0];
  double depth = 0;  // mean over the nodes of a taxel: a flat taxel lies higher over the tube away from its middle
  for (int a = 0; a < per_side; ++a) {
    const double x = ((a + 0.5) / per_side - 0.5) * width;
    depth += (kRadius - std::sqrt(kTube * kTube - x * x)) / per_side;
  }
  for (int i = 0; i < kAround; ++i) {
    for (int j = 1; j < kAlong - 1; ++j) {
      const auto t = static_cast<std::size_t>(i * kAlong + j);
      EXPECT_NEAR(frame.ground_truth.tactile_normal_force[t] / (kStiffness * width * kPitch), depth, kFlat * depth) << "taxel " << t;
    }
  }
}

TEST(LinkedFoundationOnEveryDriver, BatchesAndWorkgroupsGiveTheSameBytes) {
  constexpr int kInstances = 5;
  const Sensor sensor = onFoundation(support::cylinderFingertip(8e-3, 0.6, 5, 3, 2.4e-3), 2);
  Random random(11);
  const std::vector<Object> objects{Sphere{0.004}, support::icosphere(0.008, 2, 0.05, random)};
  std::vector<Touch> touches;
  std::vector<float> loads;
  for (int i = 0; i < kInstances; ++i) {
    touches.push_back({{i % 2}, {{{random.uniform(-2e-3, 2e-3), random.uniform(-2e-3, 2e-3), i % 2 ? 7.5e-3 : 3.6e-3}, {1, 0, 0, 0}}}});
    loads.push_back(i == 2 ? 1.5f : kPoseDriven);
  }
  const auto run = [&](const Model& model, const std::vector<int>& instances) {
    const int n = static_cast<int>(instances.size());
    Simulator simulator(model, {.num_instances = n});
    std::vector<Touch> chosen;
    std::vector<float> chosen_loads;
    for (const int i : instances) {
      chosen.push_back(touches[static_cast<std::size_t>(i)]);
      chosen_loads.push_back(loads[static_cast<std::size_t>(i)]);
    }
    simulator.setLoads(chosen_loads);
    const FrameView frame = step(simulator, chosen);
    std::vector<std::vector<std::uint32_t>> bits;
    for (int i = 0; i < n; ++i) bits.push_back(support::bitsOf(frame, i, n));
    EXPECT_GT(frame.ground_truth.total_force[0], 0);
    return bits;
  };
  const std::vector<int> all{0, 1, 2, 3, 4};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  const auto together = run(model, all);
  for (const int i : all) EXPECT_EQ(together[static_cast<std::size_t>(i)], run(model, {i})[0]) << i;
  const Model wider(support::sharedDevice(), {.sensor = sensor, .objects = objects, .contact_workgroup = 64});
  EXPECT_EQ(together, run(wider, all));
}

}  // namespace
}  // namespace taxelsim
