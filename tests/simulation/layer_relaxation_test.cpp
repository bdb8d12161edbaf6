// Relaxation of the law `elastic_layer` on the device: against the twin and general properties. Closed forms: relaxation_test.cpp.
#include "reference/elastic_layer.h"
#include "simulation/layer_scene.h"
#include "support/cases.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::PlacedObject;
using support::LayerOptions;
using support::layerSensor;
using support::Random;
using support::Touch;

// The load search stops at this relative error, in float32 sums.
constexpr double kCarried = 1e-3;

Sensor relaxingSensor(const LayerOptions& skin, std::vector<RelaxationTerm> terms, int samples = 1) {
  Sensor sensor = layerSensor(skin, {.num_rows = 8, .num_cols = 10, .samples_per_taxel = samples});
  sensor.skin.relaxation = std::move(terms);
  return sensor;
}

double sumOf(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// ---- the twin ----

// Largest displacement (m) under `pressure`.
double deepestUnder(const reference::Layer& layer, std::span<const double> pressure) {
  const auto rows = static_cast<std::size_t>(layer.nodes.num_rows), cols = static_cast<std::size_t>(layer.nodes.num_cols);
  double deepest = 0;
  for (std::size_t m = 0; m < rows * cols; ++m) {
    double w = 0;
    for (std::size_t n = 0; n < rows * cols; ++n) {
      const std::size_t u = std::max(m / cols, n / cols) - std::min(m / cols, n / cols);
      const std::size_t v = std::max(m % cols, n % cols) - std::min(m % cols, n % cols);
      w += layer.influence[u * cols + v] * pressure[n];
    }
    deepest = std::max(deepest, w);
  }
  return deepest;
}

struct PathKind {
  LayerOptions skin;
  int samples = 1;
  int num_slots = 1;
  bool with_loads = false;
};

class LayerRelaxationTwinSeeds : public ::testing::TestWithParam<int> {
 protected:
  // Strain pressures, those of an instantaneous press, are solved in every step with an error of forceSlack() of their sum. The pressure is
  // held + gain (P' - P), where held is a mean of earlier strains: at most twice that error.
  static void run(const PathKind& kind, int seed) {
    constexpr int kNumInstances = 3, kNumSteps = 8, kResetStep = 6;
    Random random(static_cast<std::uint64_t>(seed));
    std::vector<RelaxationTerm> terms;
    const int num_terms = 1 + seed % kMaxRelaxationTerms;
    for (int m = 0; m < num_terms; ++m) terms.push_back({0.9 / num_terms * random.uniform(0.3, 1), std::pow(10, random.uniform(-4, 0))});
    Sensor sensor = relaxingSensor(kind.skin, terms, kind.samples);
    sensor.patches[0].X_SP = {{0.003, -0.002, 0.001}, axisAngle({0, 0, 1}, 0.8)};
    const std::vector<Object> objects = support::roundObjects(random);
    std::vector<Touch> touches(kNumInstances), elsewhere(kNumInstances);
    for (std::vector<Touch>* places : {&touches, &elsewhere}) {
      for (Touch& touch : *places) touch = support::randomTouch(random, sensor, objects, kind.num_slots);
    }
    const int workgroups[] = {0, 4, 16, 32};
    const Model model(support::sharedDevice(),
                      {.sensor = sensor, .objects = objects, .contact_workgroup = workgroups[random.integer(0, 3)]});
    Simulator simulator(model, {.num_instances = kNumInstances, .num_slots = kind.num_slots});
    const reference::Layer layer = reference::makeLayer(sensor);
    std::vector<reference::SkinHistory> skins(kNumInstances, reference::SkinHistory(terms));
    double slack_seen = 0, force_seen = 0;
    for (int step = 0; step < kNumSteps; ++step) {
      const double dt = std::pow(10, random.uniform(-4, 0));
      if (step == kResetStep) {
        simulator.reset(1, 1);
        skins[1] = reference::SkinHistory(terms);
      }
      std::vector<float> loads(kNumInstances, kPoseDriven);
      for (std::size_t i = 0; kind.with_loads && i < 2; ++i) loads[i] = static_cast<float>(std::pow(10, random.uniform(-1.5, 0.5)));
      const FrameView frame = support::stepOnce(simulator, touches, dt, loads);
      support::expectWellFormed(frame, sensor, kNumInstances);
      const GroundTruthView& truth = frame.ground_truth;
      for (std::size_t i = 0; i < kNumInstances; ++i) {
        SCOPED_TRACE("step " + std::to_string(step) + ", instance " + std::to_string(i));
        const auto placed = touches[i].placed(objects, truth.load_offset[i]);
        const reference::SkinStep skin = skins[i].step(dt);
        const reference::LayerContact twin = reference::layerContact(sensor, placed, skin);
        skins[i].advance(dt, twin.strain);
        const double deepest = std::max(support::kMarginZ, deepestUnder(layer, twin.strain));
        const double offset_slack = std::isnan(loads[i]) ? 1 : 2;  // a pose that a search moves is rounded once more
        const double slack = 2 * offset_slack * support::forceSlack(sumOf(twin.strain) * layer.nodes.area(), deepest);
        const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
        for (std::size_t t = 0; t < num_taxels; ++t) {
          EXPECT_NEAR(truth.tactile_normal_force[i * num_taxels + t], twin.taxel_force[t], slack) << "taxel " << t;
          EXPECT_NEAR(truth.penetration_depth[i * num_taxels + t], twin.mean_penetration[t], 4 * support::kMarginZ) << "taxel " << t;
        }
        EXPECT_NEAR(truth.off_array_load[i], twin.off_array_load, slack);
        EXPECT_NEAR(truth.over_penetration[i], twin.over_penetration, 2.0 / (numTaxels(sensor) * kind.samples * kind.samples));
        for (std::size_t axis = 0; axis < 6; ++axis) {
          constexpr double kReach = 0.04;  // m: from S's origin to the farthest node
          EXPECT_NEAR(truth.contact_wrench[6 * i + axis], twin.wrench[axis], axis < 3 ? slack : slack * kReach) << axis;
        }
        slack_seen += slack;
        force_seen += twin.total_force + twin.off_array_load;
        if (std::isnan(loads[i])) continue;
        const auto as_found = touches[i].placed(objects);
        const reference::LayerContact search = reference::loadedLayerContact(sensor, as_found, loads[i], skin);
        EXPECT_EQ(truth.load_reached[i], search.load_reached ? 1 : 0);
        if (!search.load_reached) continue;
        EXPECT_NEAR(truth.total_force[i] + truth.off_array_load[i], loads[i], kCarried * loads[i]);
        EXPECT_NEAR(truth.load_offset[i], search.offset, 2e-4 * sensor.skin.thickness + 4 * support::kMarginZ);
      }
      for (std::size_t i = 0; i < touches.size(); ++i) {
        // Moves on, or swaps with a contact elsewhere, where the skin has had time to recover.
        if (random.chance(0.3)) {
          std::swap(touches[i], elsewhere[i]);
          continue;
        }
        for (Pose& X_SO : touches[i].X_SO) {
          for (double& coordinate : X_SO.position) coordinate += random.uniform(-0.3, 0.3) * sensor.skin.thickness;
        }
      }
    }
    EXPECT_LT(slack_seen, kLoosest * force_seen);
  }

 private:
  // Width of the bounds relative to the force; wider ones would prove little.
  static constexpr double kLoosest = 0.05;
};

TEST_P(LayerRelaxationTwinSeeds, OneObject) {
  if (GetParam() % 2 == 0) {
    run({.skin = {}}, GetParam());
  } else {
    run({.skin = {.poisson_ratio = 0.3, .base = ElasticLayer::Base::kHalfSpace}, .samples = 2}, GetParam());
  }
}

TEST_P(LayerRelaxationTwinSeeds, SeveralObjectsAndAMargin) {
  run({.skin = {.margin = 7e-3}, .num_slots = 2}, 200 + GetParam());
}

TEST_P(LayerRelaxationTwinSeeds, UnderALoad) {
  run({.skin = {.margin = GetParam() % 2 == 0 ? 0 : 7e-3}, .with_loads = true}, 300 + GetParam());
}

INSTANTIATE_TEST_SUITE_P(OnEveryDriver, LayerRelaxationTwinSeeds, support::seeds(2, 4));

// ---- general properties ----

// A bonded layer with the default solver.
Sensor bondedLayer(std::vector<RelaxationTerm> terms) {
  return relaxingSensor({.margin = 4e-3, .iterations = 10, .tolerance = 1e-3}, std::move(terms), 2);
}

// One sphere of 20 mm on a skin.
class PressedLayer {
 public:
  explicit PressedLayer(Sensor sensor)
      : sensor_(std::move(sensor)),
        model_(support::sharedDevice(), {.sensor = sensor_, .objects = {Object(Sphere{0.02})}}),
        simulator_(model_, {}) {}

  GroundTruthView press(double depth, double dt) { return step({0.3e-3, 1e-3, 0.02 - depth}, kPoseDriven, dt); }
  GroundTruthView load(double load, double dt) { return step({0.3e-3, 1e-3, 0.02}, static_cast<float>(load), dt); }
  GroundTruthView step(const Vector3& position, float load, double dt) {
    support::setTouches(simulator_, {{{0}, {{.position = position}}}});
    simulator_.setLoad(0, load);
    const FrameView frame = support::stepOnce(simulator_, dt);
    support::expectWellFormed(frame, sensor_, 1);
    return frame.ground_truth;
  }
  void reset() { simulator_.reset(0, 1); }

 private:
  Sensor sensor_;
  Model model_;
  Simulator simulator_;
};

double carriedBy(const GroundTruthView& truth) {
  return truth.total_force[0] + truth.off_array_load[0];
}

// A sphere that retracts faster than the skin recovers has no contact above its dent. Pressed again it meets less force than at first,
// after a long time the same.
TEST(ElasticLayerRelaxation, NoPressureInADent) {
  PressedLayer layer(bondedLayer({{0.6, 0.1}, {0.1, 0.5}}));
  const double first = carriedBy(layer.press(0.6e-3, 1e-3));
  for (int n = 0; n < 20; ++n) layer.press(0.6e-3, 0.1);
  for (const double depth : {0.3e-3, 0.1e-3}) {
    const GroundTruthView truth = layer.press(depth, 1e-4);
    EXPECT_EQ(carriedBy(truth), 0);
    for (const float component : truth.contact_wrench) EXPECT_EQ(component, 0);
    EXPECT_EQ(truth.contact_residual[0], 0);
    EXPECT_GT(*std::max_element(truth.penetration_depth.begin(), truth.penetration_depth.end()), 0.2 * depth);
  }
  const double again = carriedBy(layer.press(0.6e-3, 1e-4));
  EXPECT_GT(again, 0);
  EXPECT_LT(again, 0.9 * first);
  EXPECT_EQ(carriedBy(layer.press(-1e-3, 1e-4)), 0);
  for (int n = 0; n < 20; ++n) layer.press(-1e-3, 1);
  EXPECT_NEAR(carriedBy(layer.press(0.6e-3, 1e-6)) / first, 1, 5e-3);
}

// An incompressible layer that was pressed for long bulges around its dent: an object next to the dent touches above the level of the
// undeformed skin.
TEST(ElasticLayerRelaxation, BulgeAroundADentTouches) {
  const std::vector<RelaxationTerm> terms{{0.9, 0.1}};
  const Sensor sensor = relaxingSensor({.poisson_ratio = 0.5}, terms, 2);
  const std::vector<Object> objects{Object(Sphere{0.01}), Object(Sphere{0.004})};
  Simulator simulator = support::makeSimulator(sensor, objects);
  reference::SkinHistory skin(terms);
  const Touch pressed{{0}, {{.position = {-4e-3, 1e-3, 0.01 - 1e-3}}}}, next_to{{1}, {{.position = {2e-3, 1e-3, 0.004 + 0.01e-3}}}};
  for (const auto& [touch, dt] : {std::pair{pressed, 1.0}, {pressed, 1.0}, {next_to, 1e-3}}) {
    const double found = carriedBy(support::stepOnce(simulator, {touch}, dt).ground_truth);
    const reference::LayerContact twin = reference::layerContact(sensor, touch.placed(objects), skin.step(dt));
    skin.advance(dt, twin.strain);
    EXPECT_GT(twin.total_force, 1e-3);
    EXPECT_NEAR(found / twin.total_force, 1, 0.02);  // a depth of some 20 um under a bulge, of which kMarginZ is a hundredth
  }
}

TEST(ElasticLayerRelaxation, CarriesALoadThatSinksIn) {
  constexpr double kLoad = 2;
  PressedLayer layer(bondedLayer({{0.3, 0.1}, {0.2, 2}}));
  double before = 0, first = 0;
  for (int n = 0; n < 60; ++n) {
    const GroundTruthView truth = layer.load(kLoad, 0.05);
    EXPECT_EQ(truth.load_reached[0], 1);
    EXPECT_NEAR(carriedBy(truth), kLoad, kCarried * kLoad);
    if (n == 0) before = first = truth.load_offset[0];
    EXPECT_LT(truth.load_offset[0], before + 1e-6);  // a thousandth of the depth, by the solver
    before = truth.load_offset[0];
  }
  EXPECT_LT(before, first - 20e-6);
}

// The force at full depth falls to half: a load in between is carried at first and later out of reach.
TEST(ElasticLayerRelaxation, LoadMayGoOutOfReach) {
  PressedLayer layer(bondedLayer({{0.5, 0.1}}));
  const double load = 0.75 * carriedBy(layer.press(2e-3, 1e-3));
  layer.reset();
  EXPECT_EQ(layer.load(load, 1e-3).load_reached[0], 1);
  for (int n = 0; n < 20; ++n) layer.load(load, 0.05);
  const GroundTruthView truth = layer.load(load, 0.05);
  EXPECT_EQ(truth.load_reached[0], 0);
  constexpr double kNearest = 20e-6;  // m: the lowest node is up to 0.9 mm from the sphere's lowest point
  EXPECT_NEAR(truth.load_offset[0], -2e-3, kNearest);
  EXPECT_LT(carriedBy(truth), load);
}

// Loads of 1/10 and 1/1000 in the dent of the full load, a load below float32 resolution there, and no load.
TEST(ElasticLayerRelaxation, CarriesASmallLoadInADent) {
  constexpr double kLoad = 5;
  for (const double share : {0.1, 1e-3, 1e-9, 0.0}) {
    PressedLayer layer(bondedLayer({{0.8, 0.1}}));
    for (int n = 0; n < 20; ++n) layer.load(kLoad, 0.05);
    for (int n = 0; n < 2; ++n) {
      const GroundTruthView truth = layer.load(share * kLoad, 1e-3);
      EXPECT_EQ(truth.load_reached[0], 1) << share;
      EXPECT_NEAR(carriedBy(truth), share * kLoad, kCarried * share * kLoad) << share;
      EXPECT_LT(truth.load_offset[0], -50e-6) << share;
    }
  }
}

// One node at full depth until almost no stiffness remains: full depth is the bottom of the dent, and no load can be carried.
TEST(ElasticLayerRelaxation, CarriesLoadsInADentOfFullDepth) {
  Sensor sensor = layerSensor({.base = ElasticLayer::Base::kHalfSpace}, {.num_rows = 1, .num_cols = 1, .samples_per_taxel = 1});
  sensor.skin.relaxation = {{1 - 1e-9, 1e-3}};
  for (const double load : {0.0, 1e-6, 1.0, 1e12}) {
    PressedLayer layer(sensor);
    for (int n = 0; n < 4; ++n) layer.press(2.5e-3, 1);
    const GroundTruthView truth = layer.load(load, 1e-7);
    EXPECT_EQ(truth.load_reached[0], load > 0 ? 0 : 1) << load;
    EXPECT_EQ(carriedBy(truth), 0) << load;
  }
}

// A term with fraction 0 changes rounding only.
TEST(ElasticLayerRelaxation, ZeroFractionEqualsNoRelaxation) {
  PressedLayer relaxes(bondedLayer({{0, 0.1}})), stays(bondedLayer({}));
  for (const double depth : {0.3e-3, 0.5e-3, 0.2e-3, -0.1e-3, 0.4e-3}) {
    const double expected = carriedBy(stays.press(depth, 0.1));
    EXPECT_NEAR(carriedBy(relaxes.press(depth, 0.1)), expected, 2e-3 * expected) << depth;
  }
}

}  // namespace
}  // namespace taxelsim
