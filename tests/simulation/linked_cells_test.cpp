// The law `pasternak` on several patches with area sampling, where outlines cut links: against one patch, the twin and closed forms, under
// loads, in batches.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "reference/pasternak.h"
#include "simulation/comparison.h"
#include "simulation/foundation_forms.h"
#include "simulation/foundation_law.h"
#include "simulation/linked_sensors.h"
#include "support/curved_sensor.h"

namespace taxelsim {
namespace {

using support::Random;
using support::Touch;

Sensor withCells(Sensor sensor) {
  sensor.depth_sampling = DepthSampling::kArea;
  return sensor;
}

// One grid, whose nodes are 0.283 mm apart.
Sensor grid(int iterations = 0, int taxels_per_side = 4) {
  return withCells(onFoundation(support::gridSensor({.num_rows = taxels_per_side, .num_cols = taxels_per_side}), 4, iterations));
}

// The same as two grids with a seam in the middle, where S lies.
Sensor halves(int iterations = 0, int taxels_per_side = 4) {
  Sensor sensor = grid(iterations, taxels_per_side);
  GridPatch& patch = sensor.patches[0];
  patch.num_rows /= 2;
  sensor.patches.push_back(patch);
  sensor.patches[0].X_SP.position[0] = -patch.num_rows * patch.pitch[0] / 2;
  sensor.patches[1].X_SP.position[0] = patch.num_rows * patch.pitch[0] / 2;
  return sensor;
}

// The fingertips of scenes/sensors near their apex.
Sensor cylinder(int iterations = 0) {
  return withCells(onFoundation(support::cylinderFingertip(8e-3, 0.6, 5, 3, 2.5e-3), 3, iterations));
}
Sensor ball(int iterations = 0) {
  return withCells(onFoundation(support::sphereFingertip(8e-3, 2, 0.6), 3, iterations));
}

Sensor grids(int iterations = 0) {
  return withCells(threeGrids(iterations));
}

// Forces of one object in poses.
std::vector<double> forcesOf(const Sensor& sensor, const Object& object, const std::vector<Pose>& poses) {
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {object}});
  Simulator simulator(model, {.num_instances = static_cast<int>(poses.size())});
  std::vector<Touch> touches;
  for (const Pose& pose : poses) touches.push_back({{0}, {pose}});
  const FrameView frame = step(simulator, touches);
  return {frame.ground_truth.total_force.begin(), frame.ground_truth.total_force.end()};
}

// A seam in a plane has no effect.
TEST(LinkedCellsOnEveryDriver, TwoHalvesHaveTheForcesOfTheGrid) {
  // Active nodes end at least a decay length away, those of the grid two: the surface there is not quite exponential. Measured: 1.03e-3;
  // 2.3e-4 where active nodes end two decay lengths away as well.
  constexpr double kMargin = 1.5e-3;  // of the force
  constexpr int kPlaces = 10;
  Random random(8);
  double worst = 0;
  const std::vector<Object> objects{Cylinder{0.5e-3, 0.01}, Cylinder{1.5e-3, 0.01}, Box{{1e-3, 8e-3, 0.01}}, Sphere{5e-3}};
  const std::vector<double> tips{5e-3, 5e-3, 5e-3, 5e-3};
  for (std::size_t k = 0; k < objects.size(); ++k) {
    std::vector<Pose> poses;
    for (int n = 0; n < kPlaces; ++n) {
      const Quaternion turn = axisAngle({0, 0, 1}, random.uniform(0, 3));
      // Cells on the rim of a tilted cylinder are sums over lines, which lie otherwise in another frame.
      const Quaternion tilt = n % 2 == 0 || k < 2 ? Quaternion{1, 0, 0, 0} : random.tilt(0.1);
      poses.push_back({{random.uniform(-1e-3, 1e-3), random.uniform(-2e-3, 2e-3), tips[k] - random.uniform(0.3e-3, 1e-3)}, tilt * turn});
    }
    const std::vector<double> one = forcesOf(grid(kManySweeps), objects[k], poses);
    const std::vector<double> two = forcesOf(halves(kManySweeps), objects[k], poses);
    for (std::size_t n = 0; n < poses.size(); ++n) {
      EXPECT_NEAR(two[n], one[n], kMargin * one[n] + support::kAbsoluteForce) << "object " << k << ", place " << n;
      worst = std::max(worst, std::abs(two[n] / one[n] - 1));
    }
  }
  RecordProperty("worst", std::to_string(worst));
}

// Over the seam, which lies in the middle of the places.
TEST(LinkedCellsOnEveryDriver, ForcesMatchClosedForms) {
  expectForms(halves(0, 6),
              {pin(0.5e-3, 0.045), pin(1e-3, 0.015), pin(6e-3, 0.003), sphere(0.5e-3), sphere(1e-3, 0.01), sphere(2e-3, 0.005)});
}

double deepestOf(const reference::LayerContact& contact) {
  return *std::max_element(contact.overlap.begin(), contact.overlap.end());
}

struct Worst {
  double force = 0, depth = 0;
};

void expectLikeTwin(const FrameView& frame, std::size_t i, const Sensor& sensor, const reference::LayerContact& twin, Worst& worst) {
  // The surface at the end of the active taxels, and links that the twin knows to 1 / 240 of a side. Cut links have steps of 2e-5.
  constexpr double kLinks = 2e-3;   // of the force
  constexpr double kExtent = 0.02;  // m: from S's origin to the farthest node
  const double slack = (2 * support::kMarginZ / deepestOf(twin) + kLinks) * twin.total_force + support::kAbsoluteForce;
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  for (std::size_t t = 0; t < num_taxels; ++t) {
    EXPECT_NEAR(frame.ground_truth.tactile_normal_force[i * num_taxels + t], twin.taxel_force[t], slack) << "taxel " << t;
    EXPECT_NEAR(frame.ground_truth.penetration_depth[i * num_taxels + t], twin.mean_penetration[t], 2 * support::kMarginZ) << t;
    worst.force = std::max(worst.force,
                           std::abs(frame.ground_truth.tactile_normal_force[i * num_taxels + t] - twin.taxel_force[t]) / twin.total_force);
    worst.depth = std::max(worst.depth, std::abs(frame.ground_truth.penetration_depth[i * num_taxels + t] - twin.mean_penetration[t]));
  }
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_NEAR(frame.ground_truth.contact_wrench[6 * i + k], twin.wrench[k], k < 3 ? slack : slack * kExtent);
  EXPECT_NEAR(frame.ground_truth.over_penetration[i], twin.over_penetration, 2.0 / numTaxels(sensor));
}

// A contact with a random patch along its normal.
Pose randomContact(Random& random, const Sensor& sensor, const Object& object, const Quaternion& R_PO) {
  const Pose& X_SP = sensor.patches[static_cast<std::size_t>(random.integer(0, static_cast<int>(sensor.patches.size()) - 1))].X_SP;
  Sensor lone = sensor;
  lone.patches = {sensor.patches.front()};
  lone.patches[0].X_SP = {};
  lone.skin.law = Winkler{.normal_contact_stiffness = kStiffness};
  return X_SP *
         support::poseAtDepth(lone, object, R_PO, random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3), random.uniform(0.1e-3, 1.2e-3));
}

struct CellArrays : ::testing::TestWithParam<int> {
  static Sensor sensorOf(int kind, int iterations) {
    return kind == 0 ? cylinder(iterations) : kind == 1 ? ball(iterations) : grids(iterations);
  }
};

TEST_P(CellArrays, RandomContactsMatchTheTwin) {
  constexpr int kInstances = 12;
  const Sensor sensor = sensorOf(GetParam(), kManySweeps);
  Random random(25 + GetParam());
  const std::vector<Object> objects{Sphere{0.006}, support::icosphere(0.008, 3, 0.05, random), Box{{0.004, 0.01, 0.01}},
                                    Box{{1.1e-3, 0.9e-3, 0.01}}};
  std::vector<Touch> touches;
  for (int i = 0; i < kInstances; ++i) {
    const int id = i % 4;
    const Quaternion tilt = id == 3 ? axisAngle({0, 0, 1}, random.uniform(0, 3)) : random.tilt(0.5);
    touches.push_back({{id}, {randomContact(random, sensor, objects[static_cast<std::size_t>(id)], tilt)}});
  }
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  Simulator simulator(model, {.num_instances = kInstances});
  const FrameView frame = step(simulator, touches);
  support::expectWellFormed(frame, sensor, kInstances);
  Worst worst;
  int num_touching = 0;
  for (std::size_t i = 0; i < kInstances; ++i) {
    SCOPED_TRACE("instance " + std::to_string(i) + ": object " + std::to_string(touches[i].ids[0]));
    const reference::LayerContact twin = reference::foundationContact(sensor, touches[i].placed(objects));
    num_touching += twin.total_force > 0 ? 1 : 0;
    if (twin.total_force > 0) {
      expectLikeTwin(frame, i, sensor, twin, worst);
    } else {
      EXPECT_EQ(frame.ground_truth.total_force[i], 0);
    }
  }
  EXPECT_GE(num_touching, kInstances / 2);
  RecordProperty("worst_force", std::to_string(worst.force));
  RecordProperty("worst_depth_um", std::to_string(worst.depth * 1e6));
}

// The cells are those of the offset at which the load is carried: at that pose the force is the load.
TEST_P(CellArrays, ForcesAtThePosesOfLoadsAreTheLoads) {
  constexpr int kInstances = 8;
  constexpr double kCarried = 5e-6;  // of the load: the search ends at 1e-6, or at steps of the depth in float32, 2^-32 m of 0.1 mm
  // At the pose, the offset is rounded once with the pose, 4e-9 m at 0.03 m, and cells lie otherwise in their units. Measured: 7.5e-5.
  constexpr double kPosed = 2e-4;
  const Sensor sensor = sensorOf(GetParam(), kManySweeps);
  Random random(35 + GetParam());
  const std::vector<Object> objects{Sphere{0.006}, Box{{30e-3, 30e-3, 5e-3}}, Box{{1.1e-3, 0.9e-3, 0.01}}, Box{{4e-3, 8e-3, 0.01}}};
  std::vector<Touch> touches;
  std::vector<float> loads;
  for (int i = 0; i < kInstances; ++i) {
    const Quaternion R_SO = axisAngle({0, 0, 1}, random.uniform(0, 3)) * random.tilt(0.05);
    touches.push_back({{i % 4}, {{{random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3), 0.03}, R_SO}}});
    loads.push_back(static_cast<float>(random.uniform(0.2, i % 4 == 2 ? 0.8 : 3)));
  }
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  Simulator simulator(model, {.num_instances = kInstances});
  simulator.setLoads(loads);
  const FrameView loaded = step(simulator, touches);
  std::vector<double> carried;
  for (std::size_t i = 0; i < kInstances; ++i) {
    EXPECT_EQ(loaded.ground_truth.load_reached[i], 1) << i;
    carried.push_back(-loaded.ground_truth.contact_wrench[6 * i + 2]);
    touches[i].X_SO[0].position[2] += loaded.ground_truth.load_offset[i];
  }
  simulator.setLoads(std::vector<float>(kInstances, kPoseDriven));
  const FrameView posed = step(simulator, touches);
  double worst_carried = 0, worst_posed = 0;
  Worst worst;
  for (std::size_t i = 0; i < kInstances; ++i) {
    SCOPED_TRACE("instance " + std::to_string(i));
    EXPECT_NEAR(carried[i], loads[i], kCarried * loads[i]);
    EXPECT_NEAR(-posed.ground_truth.contact_wrench[6 * i + 2], loads[i], kPosed * loads[i]);
    worst_carried = std::max(worst_carried, std::abs(carried[i] / loads[i] - 1));
    worst_posed = std::max(worst_posed, std::abs(-static_cast<double>(posed.ground_truth.contact_wrench[6 * i + 2]) / loads[i] - 1));
    expectLikeTwin(posed, i, sensor, reference::foundationContact(sensor, touches[i].placed(objects)), worst);
  }
  RecordProperty("worst_carried", std::to_string(1e6 * worst_carried) + "e-6");
  RecordProperty("worst_posed", std::to_string(1e6 * worst_posed) + "e-6");
}

std::string nameOf(const ::testing::TestParamInfo<int>& info) {
  return info.param == 0 ? "cylinder" : info.param == 1 ? "sphere" : "grids";
}
INSTANTIATE_TEST_SUITE_P(LinkedCells, CellArrays, ::testing::Range(0, 3), nameOf);

// Steps of a hundredth of the spacing over a seam and past nodes: the force changes by little, where points have jumps of 6 %.
TEST(LinkedCells, ForcesAreContinuous) {
  constexpr int kSteps = 400, kMiddle = kSteps / 2;
  constexpr double kStep = 0.85e-3 / 3 / 100, kRadius = 0.5e-3;
  constexpr double kChange = 2 * kStep / kRadius * 0.5;  // of the force: half of what the area behind a moving edge has
  const std::vector<Object> objects{Cylinder{kRadius, 0.01}, Box{{1e-3, 8e-3, 0.01}}};
  for (int id = 0; id < 2; ++id) {
    std::vector<Pose> poses;
    for (int n = 0; n < kSteps; ++n)
      poses.push_back({{kStep * (n - kMiddle), 0.37 * kStep * n, 4e-3}, {std::cos(0.1), 0, 0, std::sin(0.1)}});
    const auto largestChange = [&](const Sensor& sensor) {
      const std::vector<double> forces = forcesOf(sensor, objects[static_cast<std::size_t>(id)], poses);
      double largest = 0;
      for (std::size_t n = 1; n < forces.size(); ++n) largest = std::max(largest, std::abs(forces[n] / forces[n - 1] - 1));
      return largest;
    };
    const double over_seam = largestChange(halves()), on_grid = largestChange(grid());
    EXPECT_LT(over_seam, kChange) << "object " << id;
    EXPECT_LT(over_seam, 1.2 * on_grid) << "object " << id;
    RecordProperty("step_seam_" + std::to_string(id), std::to_string(over_seam));
    RecordProperty("step_grid_" + std::to_string(id), std::to_string(on_grid));
  }
}

// The twin searches by bisection over frames of its own.
TEST(LinkedCells, OffsetsOfLoadsMatchTheTwin) {
  // Forces are within 2e-3 of the twin's, and grow at least as fast as the depth.
  constexpr double kLinks = 2e-3;  // of the depth
  constexpr double kLoad = 0.4;    // N
  const Sensor sensor = withCells(onFoundation(support::cylinderFingertip(8e-3, 0.3, 3, 2, 2.5e-3), 2, kManySweeps));
  const std::vector<Object> objects{Box{{1.1e-3, 0.9e-3, 0.01}}};
  const Touch touch{{0}, {{{1.1e-3, -0.1e-3, 0.02}, axisAngle({0, 0, 1}, 0.4)}}};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  Simulator simulator(model, {});
  simulator.setLoads(std::vector<float>{static_cast<float>(kLoad)});
  const FrameView frame = step(simulator, {touch});
  const reference::LayerContact twin = reference::loadedFoundationContact(sensor, touch.placed(objects), kLoad);
  EXPECT_TRUE(twin.load_reached);
  EXPECT_NEAR(-twin.wrench[2], kLoad, 1e-5 * kLoad);
  EXPECT_NEAR(frame.ground_truth.load_offset[0], twin.offset, kLinks * deepestOf(twin) + 2 * support::kMarginZ);
}

TEST(LinkedCells, LoadsBeyondTheSkinAreOutOfReach) {
  const Model model(support::sharedDevice(), {.sensor = cylinder(), .objects = {Sphere{2e-3}, Box{{1.1e-3, 0.9e-3, 0.01}}}});
  Simulator simulator(model, {.num_instances = 4});
  simulator.setLoads(std::vector<float>{1000, 1, 0, 1000});
  const Quaternion upright{1, 0, 0, 0};
  const FrameView frame = step(simulator, {{{0}, {{{0, 0, 0.02}, upright}}},
                                           {{0}, {{{0.5, 0, 0.02}, upright}}},
                                           {{0}, {{{0, 0, 0.02}, upright}}},
                                           {{1}, {{{1e-3, 0, 0.02}, upright}}}});
  EXPECT_FALSE(frame.ground_truth.load_reached[0]);
  EXPECT_FALSE(frame.ground_truth.load_reached[1]);
  EXPECT_TRUE(frame.ground_truth.load_reached[2]);
  EXPECT_FALSE(frame.ground_truth.load_reached[3]);
  EXPECT_GT(frame.ground_truth.total_force[0], 0);  // that at the skin's full thickness
  EXPECT_EQ(frame.ground_truth.total_force[1], 0);
  EXPECT_EQ(frame.ground_truth.total_force[2], 0);
  EXPECT_GT(frame.ground_truth.total_force[3], 0);
}

TEST(LinkedCellsOnEveryDriver, BatchesAndWorkgroupsGiveTheSameBytes) {
  constexpr int kInstances = 6;
  const Sensor sensor = withCells(onFoundation(support::cylinderFingertip(8e-3, 0.6, 5, 3, 2.5e-3), 2));
  Random random(11);
  const std::vector<Object> objects{Sphere{0.004}, support::icosphere(0.008, 2, 0.05, random), Box{{1.1e-3, 0.9e-3, 0.01}}};
  const std::vector<double> heights{3.6e-3, 7.5e-3, 4.4e-3};
  std::vector<Touch> touches;
  std::vector<float> loads;
  for (int i = 0; i < kInstances; ++i) {
    const auto id = static_cast<std::size_t>(i % 3);
    touches.push_back({{i % 3}, {{{random.uniform(-2e-3, 2e-3), random.uniform(-2e-3, 2e-3), heights[id]}, {1, 0, 0, 0}}}});
    loads.push_back(i >= 3 ? 0.5f : kPoseDriven);
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
  const std::vector<int> all{0, 1, 2, 3, 4, 5};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  const auto together = run(model, all);
  for (const int i : all) EXPECT_EQ(together[static_cast<std::size_t>(i)], run(model, {i})[0]) << i;
  const Model wider(support::sharedDevice(), {.sensor = sensor, .objects = objects, .contact_workgroup = 64});
  EXPECT_EQ(together, run(wider, all));
}

}  // namespace
}  // namespace taxelsim
