// Factors per instance on the skin: against a sensor whose own settings include them, on the device and in double precision.
#include "taxelsim/skin_variation.h"

#include "base/philox.h"
#include "reference/frame.h"
#include "simulation/comparison.h"
#include "support/curved_sensor.h"
#include "support/input_error.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Touch;
using ::testing::HasSubstr;

constexpr double kDt = 0.01;     // s
constexpr double kDepth = 4e-4;  // m, of the first touch; later ones are deeper
// Forces of two kernels differ by the rounding of pressures and of the poses' depths.
constexpr double kRelative = support::kRelativeForce + 2 * support::kMarginZ / kDepth;
constexpr float kLoad = 1.5f;            // N
constexpr double kLoadTolerance = 1e-5;  // of the load; the search ends within 2e-6
constexpr int kNumSteps = 4;

// A grid with friction, hysteresis, delay and a kernel.
Sensor gridSensor() {
  Sensor sensor = support::gridSensor({.num_rows = 6, .num_cols = 7, .samples_per_taxel = 3});
  sensor.skin = {.thickness = 3e-3, .law = Winkler{.normal_contact_stiffness = 1.5e8}, .friction = {1e9, 0.4}};
  sensor.psf = gaussianPsf(0.6, 3);
  Readout& readout = sensor.readout;
  readout.curve = {3000};
  readout.curve_limit = 0;
  readout.adc_bits = 16;
  readout.saturation = 65535;
  readout.trigger = 0.02;
  readout.hysteresis_strength = {0.1, 0.2};
  readout.hysteresis_width = {0.02, 0.05};
  readout.delay = 0.01;
  return sensor;
}

Sensor lugreSensor() {
  Sensor sensor = gridSensor();
  sensor.skin.friction = {};
  sensor.skin.law = LuGre{.normal_contact_stiffness = 1.5e8};
  return sensor;
}

Sensor curvedSensor() {
  Sensor sensor = gridSensor();
  sensor.patches = support::sphereFingertip(8e-3, 2, 1.2).patches;
  sensor.psf = {.sigma = 1e-3};
  return sensor;
}

const SkinVariation kVariation{.stiffness = 0.7f, .friction = 1.6f, .trigger = 1.8f, .hysteresis = 0.4f, .delay = 2};

const std::vector<Object>& objects() {
  static const std::vector<Object> kObjects{Object(Sphere{0.012})};
  return kObjects;
}

// A sphere that sinks and slides.
Touch touchAt(int step) {
  return {{0}, {{.position = {3e-4 * step, 1e-4 * step, 0.012 - kDepth - 1e-4 * step}}}};
}

struct Result {
  std::vector<double> normal, shear, counts;
  double total = 0, offset = 0;
};

std::vector<double> copyOf(std::span<const float> values) {
  return {values.begin(), values.end()};
}

Result run(Simulator& simulator, const SkinVariation& variation, float load = kPoseDriven) {
  simulator.reset(0, 3, {}, variation);
  simulator.setLoad(0, load);
  for (int n = 0; n < kNumSteps; ++n) {
    support::stepOnce(simulator, {touchAt(n)}, kDt);
  }
  const FrameView frame = simulator.read();
  return {copyOf(frame.ground_truth.tactile_normal_force),
          copyOf(frame.ground_truth.tactile_shear_force),
          {frame.tactile_image.begin(), frame.tactile_image.end()},
          frame.ground_truth.contact_wrench[2],
          frame.ground_truth.load_offset[0]};
}

double largestOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0, [](double most, double value) { return std::max(most, std::abs(value)); });
}

void expectNear(const std::vector<double>& values, const std::vector<double>& expected, double absolute) {
  ASSERT_EQ(values.size(), expected.size());
  for (std::size_t k = 0; k < values.size(); ++k) EXPECT_NEAR(values[k], expected[k], absolute) << "value " << k;
}

void expectSame(const Result& result, const Result& expected) {
  const double peak = largestOf(expected.normal);
  EXPECT_GT(peak, 0.1);
  expectNear(result.normal, expected.normal, kRelative * peak);
  expectNear(result.shear, expected.shear, 4 * kRelative * peak);  // the motion's rounding as well
  expectNear(result.counts, expected.counts, 1 + kRelative * largestOf(expected.counts));
  EXPECT_NEAR(result.offset, expected.offset, 2 * support::kMarginZ);
}

TEST(SkinVariationOnDevice, IsASensorOfSuchSettings) {
  const std::vector<std::function<Sensor()>> sensors{gridSensor, lugreSensor, curvedSensor};
  for (const auto& make : sensors) {
    const Sensor sensor = make();
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects()});
    const Model varied(support::sharedDevice(), {.sensor = variedSensor(sensor, kVariation), .objects = objects()});
    Simulator simulator(model, {.vary_skin = true}), expected(varied, {});
    expectSame(run(simulator, kVariation), run(expected, {}));
    expectSame(run(simulator, kVariation, kLoad), run(expected, {}, kLoad));
    EXPECT_GT(std::abs(run(simulator, {}).total - run(simulator, kVariation).total), 0.1) << "the factors do nothing";
  }
}

// Forces of the twin, whose kernel leaves 1 - w^2 of each force on its taxel.
TEST(SkinVariationOnDevice, MatchesTheTwin) {
  SkinVariation variation = kVariation;
  variation.psf_width = 0.6f;
  const Sensor sensor = gridSensor(), varied = variedSensor(sensor, variation);
  Simulator simulator = support::makeSimulator(sensor, objects(), {.vary_skin = true});
  const Result result = run(simulator, variation);
  reference::FrameInput input{.dt = kDt};
  reference::Lag lag(varied.readout, result.normal.size());
  std::vector<double> normal, counts;
  for (int n = 0; n < kNumSteps; ++n) {
    input.objects = touchAt(n).placed(objects());
    const reference::Frame frame = reference::simulateFrame(varied, input);
    input.previous_penetration = frame.penetration;
    input.previous_friction = frame.shear.state;
    normal.clear(), counts.clear();
    const double share = variation.psf_width * variation.psf_width;
    for (std::size_t t = 0; t < frame.spread_force.size(); ++t) {
      normal.push_back(share * frame.spread_force[t] + (1 - share) * frame.taxel_force[t]);
    }
    for (const std::uint32_t count : reference::readOut(varied, lag.step(normal, kDt))) counts.push_back(count);
  }
  expectNear(result.normal, normal, kRelative * largestOf(normal));
  expectNear(result.counts, counts, 1 + kRelative * largestOf(counts));
  EXPECT_GT(largestOf(counts), 100);
}

TEST(SkinVariationOnDevice, ForcesAddUpToTheLoad) {
  for (const Sensor& sensor : {gridSensor(), curvedSensor()}) {
    Simulator simulator = support::makeSimulator(sensor, objects(), {.vary_skin = true});
    double before = 1;
    for (const float stiffness : {0.3f, 1.0f, 2.5f}) {
      simulator.reset(0, 1, {}, {.stiffness = stiffness});
      simulator.setLoad(0, kLoad);
      const GroundTruthView truth = support::stepOnce(simulator, {touchAt(0)}, kDt).ground_truth;
      EXPECT_NEAR(truth.contact_wrench[2], -kLoad, kLoadTolerance * kLoad);
      EXPECT_TRUE(truth.load_reached[0]);
      const double depth = -truth.load_offset[0];
      EXPECT_LT(depth, before - 1e-5) << "a stiffer skin sinks less";
      before = depth;
    }
  }
}

TEST(SkinVariationOnDevice, DoesNotDependOnTheBatch) {
  const Model model(support::sharedDevice(), {.sensor = gridSensor(), .objects = objects()});
  constexpr int kNumInstances = 5;
  const auto variation = [](int i) {
    return SkinVariation{.stiffness = 0.5f + 0.3f * static_cast<float>(i),
                         .friction = 0.5f * static_cast<float>(i),
                         .trigger = 1.3f,
                         .hysteresis = 0.2f * static_cast<float>(i),
                         .delay = static_cast<float>(i),
                         .psf_width = 0.2f * static_cast<float>(i)};
  };
  Simulator batch(model, {.num_instances = kNumInstances, .vary_skin = true}), alone(model, {.vary_skin = true});
  for (int i = 0; i < kNumInstances; ++i) batch.reset(i, 1, {}, variation(i));
  for (int n = 0; n < kNumSteps; ++n) {
    support::stepOnce(batch, std::vector<Touch>(kNumInstances, touchAt(n)), kDt);
  }
  for (int i = 0; i < kNumInstances; ++i) {
    alone.reset(0, 1, {}, variation(i));
    for (int n = 0; n < kNumSteps; ++n) {
      support::stepOnce(alone, {touchAt(n)}, kDt);
    }
    EXPECT_EQ(support::bitsOf(alone.read(), 0, 1), support::bitsOf(batch.read(), i, kNumInstances)) << "instance " << i;
  }
}

// Triggers of an episode are those of a sensor whose list of triggers has the same draws.
TEST(SkinVariationOnDevice, SpreadsTheTriggersOfAnEpisode) {
  constexpr std::uint64_t kSeed = 4, kEpisode = 3;  // that of run()
  const Sensor sensor = gridSensor();
  const SkinVariation variation{.trigger = 1.5f, .trigger_spread = 0.8f};
  Sensor varied = variedSensor(sensor, variation);
  std::vector<double>& triggers = varied.readout.taxel_trigger;
  for (int t = 0; t < numTaxels(sensor); ++t) {
    const double drawn =
        gaussian({.seed = kSeed, .episode = kEpisode, .taxel = static_cast<std::uint32_t>(t), .purpose = Purpose::kTaxelTrigger});
    triggers.push_back(varied.readout.trigger * std::exp(variation.trigger_spread * drawn));
  }
  EXPECT_GT(*std::max_element(triggers.begin(), triggers.end()), 3 * *std::min_element(triggers.begin(), triggers.end()));
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects()});
  const Model spread(support::sharedDevice(), {.sensor = varied, .objects = objects()});
  Simulator simulator(model, {.seed = kSeed, .vary_skin = true}), expected(spread, {.seed = kSeed});
  expectSame(run(simulator, variation), run(expected, {}));
}

TEST(SkinVariationOnDevice, WidthKeepsTheForceAndScalesItsSpread) {
  const Sensor sensor = gridSensor();
  Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{1e-3})}, {.vary_skin = true});
  // Of a sphere on the middle taxel; the width beyond that of the contact itself.
  const auto moment_of = [&](float width) {
    simulator.reset(0, 1, {}, {.psf_width = width});
    const GroundTruthView truth =
        support::stepOnce(simulator, {{{0}, {{.position = {sensor.patches[0].pitch[0] / 2, 0, 7e-4}}}}}, kDt).ground_truth;
    EXPECT_NEAR(truth.total_force[0], -truth.contact_wrench[2], kRelative * truth.total_force[0]);
    return static_cast<double>(truth.second_moments[0]);
  };
  const double none = moment_of(0), whole = moment_of(1) - none;
  EXPECT_GT(whole, 1e-7);
  EXPECT_NEAR(moment_of(0.5f) - none, 0.25 * whole, 1e-3 * whole);
  EXPECT_NEAR(moment_of(1.2f) - none, 1.44 * whole, 1e-3 * whole);
}

TEST(SkinVariationOnDevice, RefusesWhatTheSensorCannotDo) {
  const auto refusal = [](const Sensor& sensor, const SkinVariation& variation) {
    return support::inputError([&] { checkVariation(sensor, variation); });
  };
  const Sensor grid = gridSensor();
  EXPECT_EQ(refusal(grid, {.stiffness = 0}), "stiffness: 0 is not allowed: a number from 0.05 to 20");
  EXPECT_EQ(refusal(grid, {.friction = -1}), "friction: -1 is not allowed: a number from 0 to 20");
  EXPECT_EQ(refusal(grid, {.trigger = NAN}), "trigger: nan is not allowed: a number from 0 to 20");
  EXPECT_EQ(refusal(grid, {.hysteresis = 4}), "hysteresis: 4 is not allowed: a number >= 0 and < 3.333333333333333");
  EXPECT_THAT(refusal(grid, {.psf_width = 3}), HasSubstr("psf_width: 3 is not allowed: a number from 0 to 1."));
  Sensor other = grid;
  other.skin.friction = {};
  other.skin.law = Proximity{1e6};
  other.psf = {};
  other.readout = {};
  EXPECT_THAT(refusal(other, {.stiffness = 2}), HasSubstr("stiffness: 2 is not allowed: 1, because"));
  EXPECT_THAT(refusal(other, {.friction = 2}), HasSubstr("friction: 2 is not allowed: 1, because"));
  EXPECT_EQ(refusal(other, {.trigger = 2}), "trigger: 2 is not allowed: 1, because the trigger of the sensor is 0");
  EXPECT_EQ(refusal(other, {.hysteresis = 2}), "hysteresis: 2 is not allowed: 1, because the sensor has no hysteresis");
  EXPECT_EQ(refusal(other, {.delay = 2}), "delay: 2 is not allowed: 1, because the sensor has no delay");
  EXPECT_EQ(refusal(grid, {.trigger_spread = 3}), "trigger_spread: 3 is not allowed: a number from 0 to 2");
  EXPECT_EQ(refusal(other, {.trigger_spread = 1}), "trigger_spread: 1 is not allowed: 0, because the trigger of the sensor is 0");
  EXPECT_EQ(refusal(other, {.psf_width = 0.5f}), "psf_width: 0.5 is not allowed: 1, because the sensor has no point spread function");

  const Model model(support::sharedDevice(), {.sensor = grid, .objects = objects()});
  Simulator plain(model, {});
  EXPECT_EQ(support::inputError([&] { plain.reset(0, 0, {}, kVariation); }), "skin of instance 0: a variation needs the option vary_skin");
  Simulator simulator(model, {.vary_skin = true});
  EXPECT_EQ(support::inputError([&] { simulator.reset(0, 0, {}, {.stiffness = 50}); }),
            "skin of instance 0.stiffness: 50 is not allowed: a number from 0.05 to 20");
  EXPECT_THAT(support::inputError([&] { Simulator(model, {.outputs = {.tactile_jacobian = true}, .vary_skin = true}); }),
              HasSubstr("tactile_jacobian: true is not allowed where vary_skin is true"));
  EXPECT_THAT(
      support::inputError([&] { Simulator(model, {.outputs = {.penetration_depth = false}, .max_contacts = 1, .vary_skin = true}); }),
      HasSubstr("vary_skin: true is not allowed where max_contacts > 0"));
}

}  // namespace
}  // namespace taxelsim
