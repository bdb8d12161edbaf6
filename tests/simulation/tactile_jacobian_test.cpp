// The tactile Jacobian on the device: against the twin on random scenes, against differences of moved sensors, and in batches.
#include "base/vector3.h"
#include "reference/imperfections.h"
#include "reference/psf.h"
#include "simulation/comparison.h"
#include "simulation/tactile_jacobian_rows.h"
#include "support/cases.h"
#include "support/curved_sensor.h"
#include "support/input_error.h"
#include "support/jacobian_cases.h"
#include "support/random_scene.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using support::expectJacobian;
using support::JacobianCase;
using support::JacobianErrors;
using support::JacobianKind;
using support::Random;
using support::Touch;

constexpr double kDt = 0.01;  // s
constexpr OutputOptions kAll{.tactile_jacobian = true, .clean_tactile_jacobian = true, .taxel_jacobian = true};

void expectFinite(const FrameView& frame) {
  const CleanTactileJacobianView& clean = frame.ground_truth.jacobian;
  for (const std::span<const float> values : {frame.jacobian.center_of_pressure, frame.jacobian.total_force, frame.jacobian.edge_angle,
                                              clean.center_of_pressure, clean.total_force, clean.edge_angle, clean.contact_wrench}) {
    EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); }));
  }
}

struct SceneKind {
  support::SensorRange sensor{.max_rows = 8, .max_cols = 8};
  double solid_share = 1;
  int num_slots = 1;
};

void runScene(const SceneKind& kind, int seed) {
  Random random(static_cast<std::uint64_t>(seed));
  const Sensor sensor = support::randomSensor(random, kind.sensor);
  std::vector<Object> objects;
  for (int n = 0; n < kind.num_slots; ++n) {
    objects.push_back(random.chance(kind.solid_share) ? support::randomSolid(random, 0.02) : support::randomMeshObject(random, 0.02));
  }
  std::vector<Touch> touches;
  const int num_instances = random.integer(1, 3);
  for (int i = 0; i < num_instances; ++i) {
    Touch touch;
    for (int slot = 0; slot < kind.num_slots; ++slot) {
      touch.ids.push_back(slot);
      touch.X_SO.push_back(support::randomContact(random, sensor, objects[static_cast<std::size_t>(slot)]));
    }
    touches.push_back(touch);
  }
  const int workgroups[] = {0, 4, 16, 64};
  const Model model(support::sharedDevice(), {.sensor = sensor,
                                              .objects = objects,
                                              .contact_workgroup = workgroups[random.integer(0, 3)],
                                              .image_workgroup = workgroups[random.integer(0, 3)]});
  Simulator simulator(model, {.num_instances = num_instances, .num_slots = kind.num_slots, .outputs = kAll});
  const FrameView frame = support::stepOnce(simulator, touches, kDt);
  expectFinite(frame);
  for (int i = 0; i < num_instances; ++i) expectJacobian(frame, i, sensor, touches[static_cast<std::size_t>(i)].placed(objects));
}

class JacobianSeeds : public ::testing::TestWithParam<int> {};

TEST_P(JacobianSeeds, SolidOnOnePatch) {
  runScene({}, 100 + GetParam());
}
TEST_P(JacobianSeeds, MeshOnOnePatch) {
  runScene({.solid_share = 0}, 200 + GetParam());
}
TEST_P(JacobianSeeds, SeveralObjectsOverTiltedPatches) {
  runScene({.sensor = {.max_rows = 6, .max_cols = 6, .max_patches = 3, .max_patch_tilt = 0.4}, .solid_share = 0.6, .num_slots = 3},
           300 + GetParam());
}

INSTANTIATE_TEST_SUITE_P(OnEveryDriver, JacobianSeeds, support::seeds(3, 10));

// Boxes and closed meshes, whose cells are exact integrals in both.
TEST(TactileJacobianOnEveryDriver, AreaSamplingMatchesTheTwin) {
  constexpr int kInstances = 6;
  Random random(41);
  Sensor sensor = support::gridSensor({.thickness = 2e-3});
  sensor.depth_sampling = DepthSampling::kArea;
  const std::vector<Object> objects{Object(Box{{6e-3, 9e-3, 5e-3}}), Object("stone", support::icosphere(6e-3, 2, 0, random))};
  std::vector<Touch> touches;
  for (int i = 0; i < kInstances; ++i) {
    touches.push_back({{i % 2}, {support::randomContact(random, sensor, objects[static_cast<std::size_t>(i % 2)])}});
  }
  for (const Winkler& law : {Winkler{1.73e8, 1, 0}, Winkler{4e9, 1.5, 0}}) {
    SCOPED_TRACE("exponent " + std::to_string(law.normal_exponent));
    sensor.skin.law = law;
    Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = kInstances, .outputs = kAll});
    const FrameView frame = support::stepOnce(simulator, touches, kDt);
    for (int i = 0; i < kInstances; ++i) expectJacobian(frame, i, sensor, touches[static_cast<std::size_t>(i)].placed(objects));
  }
}

// ---- against differences of moved sensors ----

support::FeatureChanges changesOf(const TactileJacobianView& view, std::size_t row) {
  support::FeatureChanges changes;
  for (std::size_t k = 0; k < 6; ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) changes.center_of_pressure[axis][k] = view.center_of_pressure[18 * row + 6 * axis + k];
    changes.total_force[k] = view.total_force[6 * row + k];
    changes.edge_angle[k] = view.edge_angle[6 * row + k];
  }
  return changes;
}

support::JacobianScale scaleOf(const FeatureView& features, bool several_contacts) {
  const double size = std::sqrt(features.second_moments[0] + features.second_moments[2]);
  return {size, length({features.center_of_pressure[0], features.center_of_pressure[1], features.center_of_pressure[2]}),
          features.edge_confidence[0], several_contacts ? size : 0, features.total_force[0]};
}

// The device at 4 x 4 samples. The tests of the twin cover 8 x 8 and all kinds of contact.
TEST(TactileJacobianOnDevice, MatchesDifferencesOfMovedSensors) {
  Random random(11);
  JacobianErrors errors;
  for (int draw = 0; draw < 2; ++draw) {
    JacobianCase contact = support::randomJacobianCase(random, draw % 2 == 0 ? JacobianKind::kRound : JacobianKind::kPatches);
    const support::JacobianChanges expected = support::centralDifferences(contact);
    contact.sensor.samples_per_taxel = 4;
    const Model model(support::sharedDevice(), {.sensor = contact.sensor, .objects = contact.objects});
    const int num_slots = static_cast<int>(contact.objects.size());
    Simulator simulator(model, {.num_slots = num_slots, .outputs = kAll});
    Touch touch{{}, contact.X_SO};
    for (int slot = 0; slot < num_slots; ++slot) touch.ids.push_back(slot);
    const FrameView frame = support::stepOnce(simulator, {touch}, kDt);
    errors.add(changesOf(frame.ground_truth.jacobian, 0), expected.sensor, scaleOf(frame.ground_truth, num_slots > 1));
    const std::vector<double> force(frame.ground_truth.tactile_normal_force.begin(), frame.ground_truth.tactile_normal_force.end());
    const bool same = expected.triggers_hold && support::reportingTaxels(contact.sensor, force) == expected.reports;
    if (same) errors.add(changesOf(frame.jacobian, 0), expected.measured, scaleOf(frame, num_slots > 1));
    std::array<std::array<double, 6>, 6> wrench{};
    for (std::size_t n = 0; n < 36; ++n) wrench[n / 6][n % 6] = frame.ground_truth.jacobian.contact_wrench[n];
    errors.addWrench(wrench, expected.contact_wrench, scaleOf(frame.ground_truth, num_slots > 1));
  }
  EXPECT_LT(errors.worst(), 0.05);
  EXPECT_LT(errors.worstAngle(), 0.1);
}

// ---- laws, loads, readouts ----

FrameView pressOnce(Simulator& simulator, const std::vector<Touch>& touches) {
  return support::stepOnce(simulator, touches, kDt);
}

std::vector<ContactLaw> laws() {
  return {Winkler{1.73e8, 1.5, 0}, MassSpringDamper{.normal_contact_stiffness = 1.73e8}, DeformationMask{}, Proximity{.sensitivity = 1e8},
          LuGre{.normal_contact_stiffness = 1.73e8}};
}

TEST(TactileJacobianOnEveryDriver, EveryLawMatchesTheTwin) {
  for (const ContactLaw& law : laws()) {
    Sensor sensor = support::gridSensor({.num_rows = 6, .num_cols = 9, .thickness = 2e-3});
    sensor.skin.law = law;
    sensor.psf = gaussianPsf(0.5, 3);
    const std::vector<Object> objects{Object(Cylinder{8e-3, 60e-3})};
    // Deep enough that cells of the mask saturate.
    const Touch touch{{0}, {{{1e-3, 0.5e-3, 8e-3 - 1.3e-3}, axisAngle({0.1, 1, 0.2}, 1.5)}}};
    Simulator simulator(Model(support::sharedDevice(), {.sensor = sensor, .objects = objects}), {.outputs = kAll});
    SCOPED_TRACE(law.index());
    expectJacobian(pressOnce(simulator, {touch}), 0, sensor, touch.placed(objects));
  }
}

TEST(TactileJacobianOnEveryDriver, UsesThePoseThatTheLoadSearchFound) {
  Random random(5);
  for (const bool tilted : {false, true}) {
    Sensor sensor = support::gridSensor({.num_rows = 7, .num_cols = 8, .thickness = 3e-3});
    // A tilted patch is searched over tiles, in separate passes.
    if (tilted) sensor.patches[0].X_SP = {{2e-3, 1e-3, 0}, axisAngle({1, 0.4, 0}, 0.15)};
    const std::vector<Object> objects{Object(Sphere{9e-3})};
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
    constexpr int kNumInstances = 3;
    Simulator simulator(model, {.num_instances = kNumInstances, .outputs = kAll});
    std::vector<Touch> touches;
    for (int i = 0; i < kNumInstances; ++i) {
      touches.push_back({{0}, {{{random.uniform(-4e-3, 4e-3), random.uniform(-4e-3, 4e-3), 8.2e-3}}}});
      if (i > 0) simulator.setLoad(i, 2.0f * static_cast<float>(i));
    }
    const FrameView frame = pressOnce(simulator, touches);
    for (int i = 0; i < kNumInstances; ++i) {
      EXPECT_EQ(frame.ground_truth.load_reached[i], 1);
      const Touch& touch = touches[static_cast<std::size_t>(i)];
      // The load is met to 2e-6.
      expectJacobian(frame, i, sensor, touch.placed(objects, frame.ground_truth.load_offset[i]));
    }
  }
}

TEST(TactileJacobianOnEveryDriver, MeasuredJacobianUsesDrawnGainsAndDeadTaxels) {
  Sensor sensor = support::gridSensor({.num_rows = 6, .num_cols = 8, .thickness = 3e-3});
  sensor.psf = gaussianPsf(0.5, 3);
  sensor.readout = support::paperReadout();
  sensor.readout.gain_spread = 0.2;
  sensor.readout.dead_taxel_probability = 0.2;
  const std::vector<Object> objects{Object(Sphere{12e-3})};
  Simulator simulator(Model(support::sharedDevice(), {.sensor = sensor, .objects = objects}),
                      {.num_instances = 2, .seed = 5, .outputs = kAll});
  std::vector<Touch> touches(2, Touch{{0}, {{{2e-3, 1e-3, 10.5e-3}}}});
  for (int i = 0; i < 2; ++i) simulator.reset(i, static_cast<std::uint64_t>(i), {.gain = 1.1f, .gain_spread = 0.1f});
  const FrameView frame = pressOnce(simulator, touches);
  EXPECT_GT(frame.saturated[0], 0);
  for (int i = 0; i < 2; ++i) {
    const reference::EpisodeKey key{.seed = 5, .episode = static_cast<std::uint64_t>(i), .gain = 1.1f, .gain_spread = 0.1f};
    reference::Imperfections imperfections(sensor.readout, static_cast<std::size_t>(numTaxels(sensor)), key);
    expectJacobian(frame, i, sensor, touches[0].placed(objects), imperfections.draw(0));
  }
}

// Relaxation under a constant pose scales the stiffness everywhere by the same factor: forces fall, derivatives of the centre do not
// change.
TEST(TactileJacobianOnDevice, RelaxationScalesForces) {
  Sensor sensor = support::gridSensor({.num_rows = 7, .num_cols = 7, .thickness = 3e-3});
  const std::vector<Object> objects{Object(Sphere{9e-3})};
  const Touch touch{{0}, {{{1e-3, -0.7e-3, 8.1e-3}}}};
  Simulator fresh(Model(support::sharedDevice(), {.sensor = sensor, .objects = objects}), {.outputs = kAll});
  const FrameView at_once = pressOnce(fresh, {touch});
  sensor.skin.relaxation = {{0.6, 0.02}};
  Simulator held(Model(support::sharedDevice(), {.sensor = sensor, .objects = objects}), {.outputs = kAll});
  for (int n = 0; n < 5; ++n) pressOnce(held, {touch});
  const FrameView later = held.read();
  const double share = later.ground_truth.total_force[0] / at_once.ground_truth.total_force[0];
  EXPECT_LT(share, 0.6);
  // With relaxation f' is not averaged over the cells of the samples, so the contact area is that of whole samples, 14 per radius.
  constexpr double kArea = 0.03;
  const auto& a = at_once.ground_truth.jacobian;
  const auto& b = later.ground_truth.jacobian;
  EXPECT_NEAR(b.total_force[2], share * a.total_force[2], kArea * share * a.total_force[2]);
  for (const std::size_t k : {0u, 1u, 5u}) {
    for (std::size_t axis = 0; axis < 2; ++axis) EXPECT_NEAR(b.center_of_pressure[6 * axis + k], a.center_of_pressure[6 * axis + k], 1e-4);
  }
}

TEST(TactileJacobianOnDevice, TaxelListsMatchTheTwin) {
  Random random(3);
  for (int kind = 0; kind < 4; ++kind) {
    Sensor sensor = support::curvedSensor(random, kind % 3);
    if (kind == 3) sensor.skin.law = DeformationMask{};
    const std::vector<Object> objects{Object(Sphere{15e-3})};
    Touch touch{{0}, {support::randomContactOnTaxel(random, sensor, objects[0])}};
    Simulator simulator(Model(support::sharedDevice(), {.sensor = sensor, .objects = objects}), {.outputs = kAll});
    const FrameView frame = pressOnce(simulator, {touch});
    EXPECT_EQ(frame.jacobian.num_rows, 1);
    SCOPED_TRACE(kind);
    expectJacobian(frame, 0, sensor, touch.placed(objects));
  }
}

// ---- batches ----

TEST(TactileJacobianOnEveryDriver, IndependentOfBatchAndWorkgroup) {
  Sensor sensor = support::gridSensor({.num_rows = 22, .num_cols = 27, .pitch_x = 1e-3, .pitch_y = 1e-3});
  support::addPatch(sensor, {{0.03, 0, 0}, axisAngle({0, 1, 0}, 0.1)});
  sensor.psf = gaussianPsf(0.6, 3);
  Random random(9);
  const std::vector<Object> objects{support::randomMeshObject(random, 0.02), Object(Sphere{8e-3})};
  std::vector<Touch> touches;
  for (int i = 0; i < 5; ++i) {
    touches.push_back({{0, 1}, {support::randomContact(random, sensor, objects[0]), support::randomContact(random, sensor, objects[1])}});
  }
  const auto run = [&](int workgroup, const std::vector<Touch>& batch) {
    const Model model(support::sharedDevice(),
                      {.sensor = sensor, .objects = objects, .contact_workgroup = workgroup, .image_workgroup = workgroup});
    const int n = static_cast<int>(batch.size());
    Simulator simulator(model, {.num_instances = n, .num_slots = 2, .outputs = kAll});
    return support::bitsOfAll(pressOnce(simulator, batch), n);
  };
  const auto expected = run(0, touches);
  for (const int workgroup : {4, 256}) EXPECT_EQ(run(workgroup, touches), expected) << workgroup;
  EXPECT_EQ(run(0, {touches[3]})[0], expected[3]);
}

TEST(TactileJacobianOnDevice, LargestArrayOverSeveralTiles) {
  const Sensor sensor = support::gridSensor({.num_rows = 128, .num_cols = 128, .pitch_x = 1e-3, .pitch_y = 1e-3, .samples_per_taxel = 2});
  const std::vector<Object> objects{Object(Sphere{0.3})};
  const Touch touch{{0}, {{{3e-3, -2e-3, 0.2994}}}};
  Simulator simulator(Model(support::sharedDevice(), {.sensor = sensor, .objects = objects}), {.outputs = kAll});
  const FrameView frame = pressOnce(simulator, {touch});
  expectJacobian(frame, 0, sensor, touch.placed(objects));
  EXPECT_NEAR(frame.ground_truth.jacobian.center_of_pressure[0], -1, 0.01);
}

TEST(TactileJacobianOnEveryDriver, MeasuredJacobianIsHeldBetweenSensorFrames) {
  Sensor sensor = support::gridSensor();
  sensor.frame_rate = 50;
  Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{0.005})}, {.outputs = kAll});
  std::vector<float> measured, clean;
  for (const double depth : {0.5e-3, 0.7e-3, 0.9e-3}) {
    const FrameView frame = pressOnce(simulator, {{{0}, {{.position = {0, 0, 0.005 - depth}}}}});
    measured.push_back(frame.jacobian.total_force[2]);
    clean.push_back(frame.ground_truth.jacobian.total_force[2]);
  }
  EXPECT_EQ(measured[0], measured[1]);
  EXPECT_NE(measured[1], measured[2]);
  EXPECT_NE(clean[0], clean[1]);
}

TEST(TactileJacobianOnDevice, EmptyUnlessRequested) {
  const Model model(support::sharedDevice(), {.sensor = support::gridSensor(), .objects = {Object(Sphere{0.005})}});
  Simulator without(model, {}), with(model, {.outputs = {.clean_tactile_jacobian = true}});
  const std::vector<Touch> touch{{{0}, {{.position = {0, 0, 0.0045}}}}};
  const FrameView a = pressOnce(without, touch), b = pressOnce(with, touch);
  EXPECT_EQ(a.ground_truth.jacobian.num_rows, 0);
  EXPECT_TRUE(a.ground_truth.jacobian.total_force.empty());
  EXPECT_TRUE(a.ground_truth.jacobian.contact_wrench.empty());
  EXPECT_EQ(b.ground_truth.jacobian.num_rows, 2);
  EXPECT_EQ(b.ground_truth.jacobian.num_patches, 1);
  EXPECT_TRUE(b.jacobian.total_force.empty());
  EXPECT_GT(Simulator::plan(model, {.outputs = {.tactile_jacobian = true}}).bytes_per_instance,
            Simulator::plan(model, {}).bytes_per_instance);
}

TEST(TactileJacobianOnDevice, ZeroWithoutContact) {
  Simulator simulator = support::makeSimulator(support::gridSensor(), {Object(Sphere{0.005})}, {.outputs = kAll});
  // Close to the skin, and far away; after a contact, whose state must not show.
  for (const double height : {0.0045, 0.0051, 0.1}) {
    const FrameView frame = pressOnce(simulator, {{{0}, {{.position = {0, 0, height}}}}});
    const CleanTactileJacobianView& clean = frame.ground_truth.jacobian;
    bool all_zero = true;
    for (const std::span<const float> values : {frame.jacobian.center_of_pressure, frame.jacobian.total_force, frame.jacobian.edge_angle,
                                                clean.center_of_pressure, clean.total_force, clean.edge_angle, clean.contact_wrench}) {
      for (const float value : values) all_zero = all_zero && value == 0;
    }
    EXPECT_EQ(all_zero, height > 0.005) << height;
  }
}

TEST(TactileJacobianOnDevice, RejectsUnsupportedModels) {
  const auto expectRefused = [](const Sensor& sensor, const SimulatorOptions& options, const char* why) {
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.005})}});
    const std::string message = support::inputError([&] { Simulator simulator(model, options); });
    EXPECT_THAT(message, ::testing::HasSubstr(why));
    EXPECT_THAT(message, ::testing::HasSubstr("tactile_jacobian"));
  };
  expectRefused(support::gridSensor(), {.outputs = {.penetration_depth = false, .clean_tactile_jacobian = true}, .max_contacts = 4},
                "max_contacts");
}

}  // namespace
}  // namespace taxelsim
