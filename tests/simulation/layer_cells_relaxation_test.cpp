// Relaxation of the law `elastic_layer` with area sampling: held and sliding pins on the device, against closed forms and the twin.
#include "reference/elastic_layer.h"
#include "simulation/comparison.h"
#include "simulation/layer_scene.h"
#include "support/cases.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::LayerOptions;
using support::layerSensor;
using support::Random;
using support::Touch;

constexpr double kLength = 0.012;  // m, of pins
constexpr double kPinRadius = 0.5e-3, kWideRadius = 1e-3;

// Cells of 0.85 mm.
Sensor relaxingCells(const LayerOptions& skin, std::vector<RelaxationTerm> terms) {
  Sensor sensor = layerSensor(skin, {.num_rows = 3, .num_cols = 4, .pitch_x = 3.4e-3, .pitch_y = 3.4e-3, .samples_per_taxel = 4});
  sensor.depth_sampling = DepthSampling::kArea;
  sensor.skin.relaxation = std::move(terms);
  return sensor;
}

Touch pinAt(double x, double y, double depth, int id = 0) {
  return {{id}, {{{x, y, kLength / 2 - depth}, {1, 0, 0, 0}}}};
}

double carriedBy(const FrameView& frame, std::size_t i) {
  return frame.ground_truth.total_force[i] + frame.ground_truth.off_array_load[i];
}

// Prony series of the force of an indentation that is held from the first step on.
double shareHeld(const std::vector<RelaxationTerm>& terms, double time) {
  double share = 1;
  for (const RelaxationTerm& term : terms) share -= term.fraction * -std::expm1(-time / term.time);
  return share;
}

// ---- closed forms ----

// A pin that is held has the force of the Prony series wherever it lies, since its cells do not change. The error is that of the solver,
// twice.
TEST(ElasticLayerAreaRelaxationOnEveryDriver, HeldPinsFollowThePronySeries) {
  constexpr int kPlaces = 32;
  constexpr double kDepth = 1e-3, kError = 1e-3;
  const std::vector<RelaxationTerm> terms{{0.5, 0.05}, {0.2, 1}};
  for (const LayerOptions& skin : {LayerOptions{.poisson_ratio = 0.3, .base = ElasticLayer::Base::kHalfSpace}, LayerOptions{}}) {
    const Model model(support::sharedDevice(),
                      {.sensor = relaxingCells(skin, terms), .objects = {Cylinder{kPinRadius, kLength}, Cylinder{kWideRadius, kLength}}});
    Simulator simulator(model, {.num_instances = kPlaces});
    Random random(3);
    std::vector<Touch> touches;
    for (int i = 0; i < kPlaces; ++i)
      touches.push_back(pinAt(random.uniform(-1.7e-3, 1.7e-3), random.uniform(-1.7e-3, 1.7e-3), kDepth, i % 2));
    std::vector<double> first;
    double time = 0;
    for (const double dt : {0.01, 0.02, 0.05, 0.3, 2.0}) {
      const FrameView frame = support::stepOnce(simulator, touches, dt);
      if (first.empty()) {
        for (std::size_t i = 0; i < kPlaces; ++i) first.push_back(carriedBy(frame, i));
        continue;
      }
      time += dt;
      for (std::size_t i = 0; i < kPlaces; ++i) {
        EXPECT_NEAR(carriedBy(frame, i) / first[i], shareHeld(terms, time), kError) << "place " << i << " after " << time << " s";
      }
    }
  }
}

// After a lift the dent recovers: pressed at once, a pin meets less force than at first; after a long time the same.
TEST(ElasticLayerAreaRelaxation, TheDentOfAPinRecovers) {
  constexpr double kError = 2e-3;
  const Model model(support::sharedDevice(),
                    {.sensor = relaxingCells({}, {{0.6, 0.1}, {0.1, 0.5}}), .objects = {Cylinder{kWideRadius, kLength}}});
  Simulator simulator(model, {});
  const auto press = [&](double depth, double dt) {
    return carriedBy(support::stepOnce(simulator, {pinAt(0.3e-3, 0.5e-3, depth)}, dt), 0);
  };
  const double first = press(0.5e-3, 1e-3);
  for (int n = 0; n < 10; ++n) press(0.5e-3, 0.1);
  EXPECT_EQ(press(0.1e-3, 1e-4), 0);
  const double again = press(0.5e-3, 1e-4);
  EXPECT_GT(again, 0);
  EXPECT_LT(again, 0.9 * first);
  EXPECT_EQ(press(-1e-3, 1e-4), 0);
  for (int n = 0; n < 20; ++n) press(-1e-3, 1);
  EXPECT_NEAR(press(0.5e-3, 1e-6) / first, 1, kError);
}

// ---- sliding ----

// Pins that slide, faster and slower than the skin relaxes. Within kStep the force of a cell that enters or leaves the contact changes by
// about its share of the pin's area, up to kStep / radius, and its edge is four times as stiff as the mean.
TEST(ElasticLayerAreaRelaxationOnEveryDriver, SlidingPinsHaveAContinuousForce) {
  constexpr int kSteps = 200, kSettling = 50;
  constexpr double kStep = 0.01e-3, kDepth = 0.5e-3, kLargestChange = 4 * kStep / kPinRadius;
  const std::vector<double> steps{1e-4, 1e-2, 1};  // s; the term's time is 0.1 s
  const Model model(support::sharedDevice(), {.sensor = relaxingCells({}, {{0.7, 0.1}}), .objects = {Cylinder{kPinRadius, kLength}}});
  double worst = 0;
  for (const double dt : steps) {
    Simulator simulator(model, {.num_instances = 3});
    std::array<double, 3> before{}, first{};
    for (int n = 0; n < kSteps; ++n) {
      const double along = n * kStep;
      support::setTouches(simulator,
                          {pinAt(along, 0.1e-3, kDepth), pinAt(0.6 * along, 0.8 * along, kDepth), pinAt(0.425e-3, -along, kDepth)});
      const FrameView frame = support::stepOnce(simulator, dt);
      for (std::size_t i = 0; i < 3; ++i) {
        const double force = carriedBy(frame, i);
        ASSERT_TRUE(std::isfinite(force));
        for (const float f : frame.ground_truth.tactile_normal_force) EXPECT_GE(f, 0);
        if (n == 0) first[i] = force;
        EXPECT_GT(force, 0.2 * first[i]) << n;
        EXPECT_LT(force, 1.2 * first[i]) << n;
        // A contact that was just made relaxes with time, not by its motion.
        if (n > kSettling) worst = std::max(worst, std::abs(force - before[i]) / first[i]);
        before[i] = force;
      }
    }
  }
  EXPECT_LT(worst, kLargestChange);
  std::printf("largest change of force in %.2f mm: %.4f of the first force\n", kStep * 1e3, worst);
}

// ---- the twin ----

// Packed centroids and the sides of round ends, as in layer_cells_test.cpp; twice, since strains and pressures are solved with the same
// error.
constexpr double kSlivers = 2e-2;

// Pins and a box, pressed, moved, lifted and pressed again, by pose and by load.
TEST(ElasticLayerAreaRelaxationOnEveryDriver, MatchesTheTwin) {
  constexpr int kInstances = 6, kFrames = 5;
  Random random(5);
  const std::vector<RelaxationTerm> terms{{0.4, 0.02}, {0.3, 0.5}};
  const Sensor sensor = relaxingCells({.poisson_ratio = 0.45, .margin = 1.7e-3}, terms);
  const std::vector<Object> objects{Cylinder{kPinRadius, kLength}, Cylinder{kWideRadius, kLength}, Box{{0.9e-3, 3e-3, kLength}}};
  Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = kInstances});
  std::vector<Touch> touches;
  for (int i = 0; i < kInstances; ++i)
    touches.push_back(pinAt(random.uniform(-2e-3, 2e-3), random.uniform(-2e-3, 2e-3), random.uniform(0.4e-3, 1e-3), i % 3));
  std::vector<float> loads(kInstances, static_cast<float>(kPoseDriven));
  loads[1] = 0.5f;
  loads[4] = 1;
  std::vector<reference::SkinHistory> skins(kInstances, reference::SkinHistory(terms));
  for (int f = 0; f < kFrames; ++f) {
    const double dt = std::pow(10, random.uniform(-3, -0.5));
    const FrameView frame = support::stepOnce(simulator, touches, dt, loads);
    support::expectWellFormed(frame, sensor, kInstances);
    for (std::size_t i = 0; i < kInstances; ++i) {
      SCOPED_TRACE("frame " + std::to_string(f) + " instance " + std::to_string(i));
      const auto placed = touches[i].placed(objects);
      const reference::SkinStep skin = skins[i].step(dt);
      const bool by_load = !std::isnan(loads[i]);
      const reference::LayerContact twin =
          by_load ? reference::loadedLayerContact(sensor, placed, loads[i], skin) : reference::layerContact(sensor, placed, skin);
      skins[i].advance(dt, twin.strain, twin.dent_compliance);
      double strained = 0;
      for (const double strain : twin.strain) strained += strain * 0.85e-3 * 0.85e-3;
      const double slack = support::forceSlack(strained, 0.2e-3) + kSlivers * strained;
      const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
      for (std::size_t t = 0; t < num_taxels; ++t) {
        EXPECT_NEAR(frame.ground_truth.tactile_normal_force[i * num_taxels + t], twin.taxel_force[t], slack) << "taxel " << t;
      }
      EXPECT_NEAR(frame.ground_truth.off_array_load[i], twin.off_array_load, slack);
      if (by_load) {
        EXPECT_NEAR(frame.ground_truth.load_offset[i], twin.offset, 0.01 * sensor.skin.thickness);
      }
      touches[i].X_SO[0].position[0] += random.uniform(-0.3e-3, 0.3e-3);
      touches[i].X_SO[0].position[1] += random.uniform(-0.3e-3, 0.3e-3);
      touches[i].X_SO[0].position[2] += f == 2 ? 0.3e-3 : f == 3 ? -0.3e-3 : 0;
    }
  }
}

}  // namespace
}  // namespace taxelsim
