// A skin that relaxes on the device: closed forms, loads and other laws. With friction: shear_test.cpp.
#include "simulation/comparison.h"
#include "support/cases.h"
#include "support/random_scene.h"
#include "support/relaxation_cases.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Press;
using support::Pressed;
using support::RelaxationCases;
using support::Touch;

std::vector<Pressed> simulateByDevice(const Sensor& sensor, const Object& object, const std::vector<Press>& steps) {
  Simulator simulator = support::makeSimulator(sensor, {object});
  std::vector<Pressed> result;
  for (const Press& step : steps) {
    support::setTouches(simulator, {{{0}, {step.X_SO}}});
    simulator.setLoad(0, step.load ? static_cast<float>(*step.load) : kPoseDriven);
    const GroundTruthView truth = support::stepOnce(simulator, step.dt).ground_truth;
    const auto forces = truth.tactile_normal_force;
    result.push_back(
        {truth.total_force[0], *std::min_element(forces.begin(), forces.end()), truth.load_offset[0], truth.load_reached[0] > 0});
  }
  return result;
}

const RelaxationCases kDevice{simulateByDevice, support::kMarginZ, !support::runsAllCases()};

class RelaxationClosedFormOnDevice : public ::testing::TestWithParam<support::RelaxationCase> {};

TEST_P(RelaxationClosedFormOnDevice, Holds) {
  (kDevice.*GetParam().check)();
}

INSTANTIATE_TEST_SUITE_P(Cases, RelaxationClosedFormOnDevice, ::testing::ValuesIn(support::kRelaxationCases),
                         [](const auto& row) { return row.param.name; });

TEST(RelaxationOnEveryDriver, DeadLoadOnASphere) {
  kDevice.deadLoadOnASphere();
}

// An object under a constant load sinks in, and the load stays carried; in one tile and over several, for a mesh and a solid.
TEST(RelaxationOnDevice, CarriesALoadThatSinksIn) {
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

// The force at full depth falls to half: a load in between is carried at first and later out of reach.
TEST(RelaxationOnDevice, LoadMayGoOutOfReach) {
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

// Loads of 1/10 and 1/1000 in the dent of the full load, a load below float32 resolution there (carried, or reported as out of reach), and
// no load.
TEST(RelaxationOnDevice, CarriesASmallLoadInADent) {
  Sensor sensor = support::gridSensor();
  sensor.skin.relaxation = {{0.8, 0.1}};
  for (const double share : {0.1, 1e-3, 1e-9, 0.0}) {
    std::vector<Press> steps(20, {{.position = {0.3e-3, 1e-3, 0.03}}, 0.05, 5.0});
    steps.resize(22, {{.position = {0.3e-3, 1e-3, 0.03}}, 1e-3, 5.0 * share});
    const std::vector<Pressed> pressed = simulateByDevice(sensor, Object(Sphere{0.02}), steps);
    for (std::size_t n = 20; n < pressed.size(); ++n) {
      EXPECT_TRUE(pressed[n].reached || share < 1e-6);
      // The dent of the first load is rounded: sums of some hundred strains.
      EXPECT_NEAR(pressed[n].force, 5 * share, 0.001 * 5 * share + 5e-6 * 5) << share;
      EXPECT_LT(0.03 + pressed[n].offset, 0.02 - 50e-6) << share;  // in the dent
    }
  }
}

TEST(RelaxationOnDevice, OtherLawsFollowTheRelaxedForce) {
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
  // Almost critically damped, settled after 0.1 s: rate 128 /s, decay 65 /s.
  for (std::size_t n = 0; n < steps.size(); ++n) {
    EXPECT_NEAR(with_mask[n].force, pressed[n].force, 1e-5 * pressed[n].force);
    EXPECT_NEAR(with_masses[n].force, pressed[n].force, 0.005 * pressed[n].force);
  }
  EXPECT_LT(pressed[1].force, 0.8 * pressed[0].force);
}

// Contact points of another engine have their own forces: the skin does not relax.
TEST(RelaxationOnDevice, ContactsDoNotRelax) {
  Sensor sensor = support::gridSensor();
  sensor.skin.relaxation = {{0.5, 0.1}};
  Simulator simulator = support::makeSimulator(sensor, {}, {.outputs = {.penetration_depth = false}, .max_contacts = 1});
  simulator.setContacts(0, std::vector<ContactPoint>{{.position = {1e-3, 1e-3, 0}, .normal_force = 2}});
  for (int n = 0; n < 3; ++n) {
    EXPECT_NEAR(support::stepOnce(simulator, 1).ground_truth.total_force[0], 2, 1e-5);
  }
}

}  // namespace
}  // namespace taxelsim
