// The law `elastic_layer` on the device: against the twin and closed forms, under loads, and over several frames.
#include "reference/elastic_layer.h"
#include "simulation/comparison.h"
#include "simulation/layer_scene.h"
#include "support/random_scene.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using Base = ElasticLayer::Base;
using support::kModulus;
using support::kTightTolerance;
using support::LayerOptions;
using support::layerSensor;
using support::Random;
using support::Touch;

constexpr double kDt = 1e-2;  // s

double deepestOf(const Sensor& sensor, const std::vector<reference::PlacedObject>& placed) {
  const std::vector<double> heights = reference::layerHeights(sensor, layerNodes(sensor), placed);
  return std::min(sensor.skin.thickness, -*std::min_element(heights.begin(), heights.end()));
}

// Compares all outputs of the law for one instance with the twin's.
void expectLikeTwin(const FrameView& frame, std::size_t i, const Sensor& sensor, const reference::LayerContact& twin, double slack) {
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  const GroundTruthView& truth = frame.ground_truth;
  for (std::size_t t = 0; t < num_taxels; ++t) {
    EXPECT_NEAR(truth.tactile_normal_force[i * num_taxels + t], twin.taxel_force[t], slack) << "taxel " << t;
  }
  EXPECT_NEAR(truth.off_array_load[i], twin.off_array_load, slack);
  EXPECT_LE(truth.contact_residual[i], kTightTolerance);
  constexpr double kReach = 0.04;  // m: from S's origin to the farthest node
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(truth.contact_wrench[6 * i + k], twin.wrench[k], k < 3 ? slack : slack * kReach);
  }
}

struct LayerCase {
  LayerOptions skin;
  int samples_per_taxel;
};

void PrintTo(const LayerCase& layer, std::ostream* out) {
  *out << layer.samples_per_taxel << " samples per taxel, thickness " << layer.skin.thickness << ", Poisson's ratio "
       << layer.skin.poisson_ratio;
}

class ElasticLayerTwin : public ::testing::TestWithParam<LayerCase> {};

TEST_P(ElasticLayerTwin, RandomContacts) {
  constexpr int kInstances = 12;
  const auto [skin, samples] = GetParam();
  Random random(static_cast<std::uint64_t>(samples) + 7);
  Sensor sensor = layerSensor(skin, {.samples_per_taxel = samples});
  // A level patch, rotated and moved.
  sensor.patches[0].X_SP = {{0.003, -0.002, 0.001}, {std::cos(0.4), 0, 0, std::sin(0.4)}};
  const std::vector<Object> objects = support::roundObjects(random);
  std::vector<Touch> touches;
  for (int i = 0; i < kInstances; ++i) touches.push_back(support::randomTouch(random, sensor, objects));
  Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = kInstances});
  const FrameView frame = support::stepOnce(simulator, touches, kDt);
  support::expectWellFormed(frame, sensor, kInstances);
  for (std::size_t i = 0; i < kInstances; ++i) {
    SCOPED_TRACE("instance " + std::to_string(i) + ": object " + std::to_string(touches[i].ids[0]));
    const auto placed = touches[i].placed(objects);
    const double deepest = deepestOf(sensor, placed);
    const reference::LayerContact twin = reference::layerContact(sensor, placed);
    if (deepest > 0) expectLikeTwin(frame, i, sensor, twin, support::forceSlack(twin.total_force + twin.off_array_load, deepest));
    const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
    for (std::size_t t = 0; t < num_taxels; ++t) {
      EXPECT_NEAR(frame.ground_truth.penetration_depth[i * num_taxels + t], twin.mean_penetration[t], 2 * support::kMarginZ);
    }
    EXPECT_NEAR(frame.ground_truth.over_penetration[i], twin.over_penetration, 2.0 / (numTaxels(sensor) * samples * samples));
  }
}

INSTANTIATE_TEST_SUITE_P(Layers, ElasticLayerTwin,
                         ::testing::Values(LayerCase{{.poisson_ratio = 0.3, .base = Base::kHalfSpace}, 2},
                                           LayerCase{{.poisson_ratio = 0.49, .margin = 4e-3}, 2},
                                           LayerCase{{.thickness = 1e-3, .poisson_ratio = 0.5}, 3},
                                           // Several tiles of the contact pass.
                                           LayerCase{{.thickness = 1e-3, .poisson_ratio = 0.4, .margin = 6e-3, .iterations = 30}, 8},
                                           LayerCase{{.thickness = 4e-3, .poisson_ratio = 0.45, .margin = 1e-3}, 1}));

// As many samples a taxel as there may be, on a grid as small as those of the cases above.
TEST(ElasticLayerOnDevice, MostSamplesMatchTheTwin) {
  const Sensor sensor = layerSensor({.thickness = 1e-3, .poisson_ratio = 0.4, .margin = 1e-3},
                                    {.num_rows = 2, .num_cols = 3, .samples_per_taxel = kMaxSamplesPerTaxel});
  const Touch touch{{0}, {{{1e-3, -0.7e-3, 4.6e-3}, {1, 0, 0, 0}}}};
  const std::vector<Object> objects{Sphere{5e-3}};
  Simulator simulator = support::makeSimulator(sensor, objects);
  const FrameView frame = support::stepOnce(simulator, {touch}, kDt);
  const auto placed = touch.placed(objects);
  const reference::LayerContact twin = reference::layerContact(sensor, placed);
  ASSERT_GT(twin.total_force, 0);
  expectLikeTwin(frame, 0, sensor, twin, support::forceSlack(twin.total_force + twin.off_array_load, deepestOf(sensor, placed)));
}

// More than 32 rows and more than 32 strips per row, so that a bit of the sources covers two of them.
TEST(ElasticLayerOnDevice, GridsOfManyStripsMatchTheTwin) {
  const Sensor sensor =
      layerSensor({.thickness = 1e-3, .poisson_ratio = 0.4, .iterations = 30}, {.num_rows = 5, .num_cols = 17, .samples_per_taxel = 8});
  ASSERT_GT(layerNodes(sensor).num_cols, 4 * 32);
  const double spacing = sensor.patches[0].pitch[1] / 8;
  const std::vector<Object> objects{Sphere{5e-3}};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  std::vector<Touch> touches;
  for (int strips = 0; strips < 3; ++strips) {
    touches.push_back({{0}, {{{1e-3 + strips * spacing, 12e-3 + strips * 4 * spacing, 4.6e-3}, {1, 0, 0, 0}}}});
  }
  Simulator simulator(model, {.num_instances = 3});
  const FrameView frame = support::stepOnce(simulator, touches, kDt);
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const auto placed = touches[i].placed(objects);
    const reference::LayerContact twin = reference::layerContact(sensor, placed);
    ASSERT_GT(twin.total_force, 0);
    expectLikeTwin(frame, i, sensor, twin, support::forceSlack(twin.total_force + twin.off_array_load, deepestOf(sensor, placed)));
  }
}

// ---- closed forms ----

// Sneddon's exact solution for a sphere on a half-space, as tests/reference/elastic_layer_test.cpp for the twin.
TEST(ElasticLayerOnDevice, SphereCarriesSneddonsForce) {
  constexpr double kForceError = 0.02, kPeakError = 0.03;
  constexpr double kRadius = 0.02, kContact = 0.004;
  constexpr int kInstances = 16;
  const Sensor sensor =
      layerSensor({.thickness = 5e-3, .base = Base::kHalfSpace},
                  {.num_rows = 14, .num_cols = 14, .pitch_x = kContact / 4, .pitch_y = kContact / 4, .samples_per_taxel = 1});
  const double logarithm = std::log((kRadius + kContact) / (kRadius - kContact));
  const double depth = kContact / 2 * logarithm, plane_modulus = kModulus / (1 - 0.49 * 0.49);
  const double force = plane_modulus / 2 * ((kContact * kContact + kRadius * kRadius) * logarithm - 2 * kContact * kRadius);
  Random random(4);
  std::vector<Touch> touches;
  for (int i = 0; i < kInstances; ++i) {
    touches.push_back(
        {{0}, {{{random.uniform(-1, 1) * kContact / 8, random.uniform(-1, 1) * kContact / 8, kRadius - depth}, {1, 0, 0, 0}}}});
  }
  Simulator simulator = support::makeSimulator(sensor, {Sphere{kRadius}}, {.num_instances = kInstances});
  const FrameView frame = support::stepOnce(simulator, touches, kDt);
  for (std::size_t i = 0; i < kInstances; ++i) {
    EXPECT_NEAR(frame.ground_truth.total_force[i] / force, 1, kForceError);
    const double peak = frame.ground_truth.peak_force[i] / (kContact * kContact / 16);
    EXPECT_NEAR(peak / (2 * plane_modulus * kContact / (std::numbers::pi * kRadius)), 1, kPeakError);
  }
}

// A sphere on an incompressible layer of half the contact radius: 8.468 times Hertz's force at that depth (sqrt(R delta)/h = 1.3489).
TEST(ElasticLayerOnDevice, SphereOnABondedLayerCarriesTheTabulatedForce) {
  constexpr double kForceError = 0.02;
  constexpr double kRadius = 0.2, kThickness = 2e-3, kChi = 1.3489, kOverHertz = 8.46801;
  const double depth = kChi * kChi * kThickness * kThickness / kRadius;
  const Sensor sensor = layerSensor({.thickness = kThickness, .poisson_ratio = 0.5},
                                    {.num_rows = 30, .num_cols = 30, .pitch_x = 4e-4, .pitch_y = 4e-4, .samples_per_taxel = 1});
  Simulator simulator = support::makeSimulator(sensor, {Sphere{kRadius}});
  const FrameView frame = support::stepOnce(simulator, {{{0}, {{{1e-4, -5e-5, kRadius - depth}, {1, 0, 0, 0}}}}}, kDt);
  const double hertz = 4.0 / 3 * kModulus / 0.75 * std::sqrt(kRadius) * std::pow(depth, 1.5);
  EXPECT_NEAR(frame.ground_truth.total_force[0] / hertz / kOverHertz, 1, kForceError);
}

// ---- loads ----

TEST(ElasticLayerOnDevice, TaxelsAndMarginCarryTheLoad) {
  constexpr double kCarried = 1e-3;
  const Sensor sensor = layerSensor({.margin = 4e-3}, {.samples_per_taxel = 2});
  Random random(5);
  const std::vector<Object> objects = support::roundObjects(random);
  std::vector<Touch> touches;
  std::vector<float> loads;
  const auto add = [&](const Touch& touch, double load) {
    touches.push_back(touch);
    loads.push_back(static_cast<float>(load));
  };
  const Touch middle{{0}, {{{0.001, 0.002, 0.05}, {1, 0, 0, 0}}}}, border{{0}, {{{0.0103, 0.002, -0.003}, {1, 0, 0, 0}}}};
  for (const double load : {0.01, 1.0, 20.0}) add(middle, load);
  for (const double load : {0.5, 5.0}) add(border, load);
  add(middle, 1e5);                                 // more than full depth
  add({{0}, {{{0.08, 0, 0}, {1, 0, 0, 0}}}}, 1.0);  // outside the skin
  add({{kNoObject}, {Pose{}}}, 1.0);                // nothing
  add(middle, 0);
  add({{0}, {{{0, 0, 0.0115}, {1, 0, 0, 0}}}}, kPoseDriven);
  for (int n = 0; n < 6; ++n) {
    Touch touch = support::randomTouch(random, sensor, objects);
    touch.X_SO[0].position[2] += random.uniform(-0.01, 0.03);
    add(touch, random.uniform(0.1, 3));
  }
  Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = static_cast<int>(loads.size())});
  const FrameView frame = support::stepOnce(simulator, touches, kDt, loads);
  support::expectWellFormed(frame, sensor, static_cast<int>(loads.size()));
  const GroundTruthView& truth = frame.ground_truth;
  for (std::size_t i = 0; i < loads.size(); ++i) {
    SCOPED_TRACE("instance " + std::to_string(i));
    const auto placed = touches[i].placed(objects);
    if (std::isnan(loads[i])) {
      EXPECT_EQ(truth.load_reached[i], 1);
      continue;
    }
    const reference::LayerContact twin = reference::loadedLayerContact(sensor, placed, loads[i]);
    EXPECT_EQ(truth.load_reached[i], twin.load_reached ? 1 : 0);
    const double carried = truth.total_force[i] + truth.off_array_load[i];
    if (twin.load_reached) {
      EXPECT_NEAR(carried, loads[i], kCarried * loads[i]);
      EXPECT_NEAR(-truth.contact_wrench[6 * i + 2], loads[i], kCarried * loads[i]);
    }
    // Force grows at least proportionally to depth, so the relative error of the depth is at most that of the force.
    EXPECT_NEAR(truth.load_offset[i], twin.offset, 10 * kTightTolerance * sensor.skin.thickness + 2 * support::kMarginZ);
    if (loads[i] > 0.1 && std::isfinite(twin.offset)) expectLikeTwin(frame, i, sensor, twin, 1e-3 * (carried + 1e-3));
  }
  EXPECT_GT(truth.off_array_load[3], 0.01 * loads[3]);
  EXPECT_EQ(truth.load_reached[5], 0);
  EXPECT_EQ(truth.load_reached[6], 0);
  EXPECT_EQ(truth.load_reached[7], 0);
}

TEST(ElasticLayerOnDevice, RejectsALoadOnATiltedPatch) {
  Sensor sensor = layerSensor({});
  sensor.patches[0].X_SP.rotation = {std::cos(0.1), std::sin(0.1), 0, 0};
  Simulator simulator = support::makeSimulator(sensor, {Sphere{0.01}});
  EXPECT_THROW(simulator.setLoad(0, 1), Error);
  simulator.setLoad(0, kPoseDriven);
}

// ---- over several frames ----

// A warm start converges to the cold solution in fewer iterations; after reset() the bits are equal.
TEST(ElasticLayerOnDevice, WarmStartConvergesToTheColdSolution) {
  constexpr double kTolerance = 1e-4;
  const Sensor sensor = layerSensor({.tolerance = kTolerance}, {.samples_per_taxel = 2});
  const std::vector<Object> objects{Capsule{0.006, 0.02}};
  const auto touchAt = [](double x) {
    const double c = std::sqrt(0.5);
    return std::vector<Touch>{{{0}, {{{x, 0.002, 0.006 - 0.0005}, {c, c, 0, 0}}}}};
  };
  Simulator simulator = support::makeSimulator(sensor, objects);
  const auto forces = [](const FrameView& frame) {
    return std::vector<float>(frame.ground_truth.tactile_normal_force.begin(), frame.ground_truth.tactile_normal_force.end());
  };
  const std::vector<std::uint32_t> first = support::bitsOf(support::stepOnce(simulator, touchAt(0), kDt), 0, 1);
  for (int k = 1; k <= 20; ++k) support::stepOnce(simulator, touchAt(k * 1e-4), kDt);
  // A jump to the other side and back.
  support::stepOnce(simulator, touchAt(-0.008), kDt);
  support::stepOnce(simulator, touchAt(0.0019), kDt);
  const FrameView warm_frame = support::stepOnce(simulator, touchAt(0.002), kDt);
  const std::vector<float> warm = forces(warm_frame);
  const std::int32_t warm_iterations = warm_frame.ground_truth.contact_iterations[0];
  EXPECT_LE(warm_frame.ground_truth.contact_residual[0], kTolerance);
  simulator.reset(0, 0);
  const FrameView cold_frame = support::stepOnce(simulator, touchAt(0.002), kDt);
  EXPECT_LE(cold_frame.ground_truth.contact_residual[0], kTolerance);
  EXPECT_LT(warm_iterations, cold_frame.ground_truth.contact_iterations[0]);
  const double slack = 20 * kTolerance * *std::max_element(warm.begin(), warm.end());
  for (std::size_t t = 0; t < warm.size(); ++t) EXPECT_NEAR(warm[t], cold_frame.ground_truth.tactile_normal_force[t], slack);
  simulator.reset(0, 0);
  EXPECT_EQ(support::bitsOf(support::stepOnce(simulator, touchAt(0), kDt), 0, 1), first);
}

// ---- extreme parameters ----

double forceOfSphere(const Sensor& sensor, double load = kPoseDriven) {
  Simulator simulator = support::makeSimulator(sensor, {Sphere{0.01}});
  const FrameView frame = support::stepOnce(simulator, {{{0}, {{{0.0005, 0, 0.0097}, {1, 0, 0, 0}}}}}, kDt, {static_cast<float>(load)});
  support::expectWellFormed(frame, sensor, 1);
  EXPECT_LE(frame.ground_truth.contact_residual[0], kTightTolerance);
  return frame.ground_truth.total_force[0];
}

// Six orders of magnitude up and down: forces are proportional to the modulus, a thick layer equals a half-space; too thin a layer is
// rejected, also where float32 heights cannot resolve it.
TEST(ElasticLayerOnDevice, ExtremeParametersStayPhysical) {
  constexpr double kRounding = 1e-5;
  Sensor sensor = layerSensor({.poisson_ratio = 0.3}, {.samples_per_taxel = 2});
  const double usual = forceOfSphere(sensor);
  EXPECT_GT(usual, 0);
  for (const double factor : {1e-6, 1e6}) {
    Sensor other = sensor;
    std::get<ElasticLayer>(other.skin.law).elastic_modulus *= factor;
    EXPECT_NEAR(forceOfSphere(other) / (usual * factor), 1, kRounding);
  }
  Sensor thick = sensor, half_space = sensor, hair = sensor;
  thick.skin.thickness = 0.1;
  std::get<ElasticLayer>(half_space.skin.law).base = Base::kHalfSpace;
  // The finite thickness adds stiffness of 1.1 times the ratio of the contact radius, 1.7 mm, to 100 mm.
  EXPECT_NEAR(forceOfSphere(thick) / forceOfSphere(half_space), 1, 0.03);
  thick.skin.thickness *= 1e4;
  EXPECT_THROW(forceOfSphere(thick), Error);
  hair.skin.thickness *= 1e-6;
  EXPECT_THROW(forceOfSphere(hair), Error);
  std::get<ElasticLayer>(hair.skin.law).base = Base::kHalfSpace;
  EXPECT_GT(forceOfSphere(hair), 0);
  Sensor beyond = sensor;
  std::get<ElasticLayer>(beyond.skin.law).elastic_modulus = 1e38;
  EXPECT_THROW(forceOfSphere(beyond), Error);
}

}  // namespace
}  // namespace taxelsim
