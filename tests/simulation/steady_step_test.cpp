// A step of the simulation takes no memory once every kind of step has been taken: neither ours nor, in C++, the driver's.
#include <gtest/gtest.h>

#include <memory>

#include "simulation/comparison.h"
#include "support/allocations.h"
#include "support/random_scene.h"

namespace taxelsim {
namespace {

constexpr int kNumInstances = 8;
constexpr int kWarmUps = 3, kSteps = 10;
constexpr double kDt = 0.01;  // s

struct Kind {
  const char* name;
  Sensor (*sensor)();
  bool loads;
  bool everything;  // all outputs there are
};

Sensor plain() {
  return support::gridSensor({.num_rows = 5, .num_cols = 7, .samples_per_taxel = 2, .law = {1.73e8, 1, 1e5}});
}

Sensor noisy() {
  Sensor sensor = plain();
  sensor.readout = support::paperReadout();
  sensor.readout.noise = 5;
  sensor.readout.jitter = 1e-3;
  sensor.frame_rate = 60;
  return sensor;
}

Sensor withFriction() {
  Sensor sensor = plain();
  sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  return sensor;
}

class SteadyStep : public ::testing::TestWithParam<Kind> {};

TEST_P(SteadyStep, TakesNoMemory) {
  const auto& [name, sensor_of, loads, everything] = GetParam();
  const Sensor sensor = sensor_of();
  const Device device = support::openUnvalidated();
  support::Random random(5);
  const Model model(device,
                    {.sensor = sensor, .objects = {Object("ball", Sphere{.radius = 8e-3}), support::randomMeshObject(random, 0.02)}});
  Simulator simulator(model, {.num_instances = kNumInstances,
                              .seed = 3,
                              .outputs = {.contact_features = everything,
                                          .clean_contact_features = everything,
                                          .tactile_jacobian = everything,
                                          .clean_tactile_jacobian = everything}});
  std::vector<int> ids;
  std::vector<Pose> X_SO;
  for (int i = 0; i < kNumInstances; ++i) {
    ids.push_back(i % 2);
    X_SO.push_back(support::randomContact(random, sensor, model.objects()[static_cast<std::size_t>(i % 2)]));
  }
  const std::vector<float> forces(kNumInstances, loads ? 1.0f : kPoseDriven);
  const auto step = [&] {
    for (Pose& pose : X_SO) pose.position[0] += 1e-5;
    simulator.setObjects(ids, X_SO);
    simulator.setLoads(forces);
    simulator.step(kDt);
    return simulator.read().total_force[0];
  };
  for (int i = 0; i < kWarmUps; ++i) step();
  const support::NoAllocations watch;
  for (int i = 0; i < kSteps; ++i) step();
  EXPECT_EQ(watch.count(), 0u) << "in " << kSteps << " steps";
}

INSTANTIATE_TEST_SUITE_P(Kinds, SteadyStep,
                         ::testing::Values(Kind{"poses", plain, false, false}, Kind{"loads", plain, true, false},
                                           Kind{"noise", noisy, true, false}, Kind{"friction", withFriction, false, false},
                                           Kind{"everything", plain, false, true}),
                         [](const auto& param) { return std::string(param.param.name); });

TEST(SteadyStep, WhatTakesMemoryIsSeen) {
  const support::NoAllocations watch;
  const auto mine = std::make_unique<std::vector<double>>(1000);
  const Sensor copied = noisy();
  EXPECT_GT(watch.count(), 2u);
}

}  // namespace
}  // namespace taxelsim
