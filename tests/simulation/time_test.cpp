// What lasts from step to step: damping, the sensor's frame rate, and what a reset forgets.
#include "simulation/comparison.h"
#include "support/cases.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Bounded;
using support::Random;
using support::Touch;

TEST(DampingOnEveryDriver, MatchesTheTwinAcrossSteps) {
  for (int seed = 0; seed < support::numCases(3, 8); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    Sensor sensor = support::randomSensor(random, {.max_patches = 2});
    const double stiffness = 1e5 / sensor.skin.thickness;
    // Rates are a few tenths of a millimetre per step: damping and elastic pressure are alike.
    sensor.skin.law = Winkler{stiffness, 1, stiffness * 0.01};
    const std::vector<Object> objects{support::randomMeshObject(random, 0.02)};
    Simulator simulator = support::makeSimulator(sensor, objects);
    Touch touch{{0}, {support::randomContact(random, sensor, objects[0])}};
    std::optional<Bounded> previous;
    for (int step = 0; step < 6; ++step) {
      if (step == 4) {
        simulator.reset(0, 1);  // at rest again
        previous.reset();
      }
      const double dt = random.uniform(0.005, 0.02);
      support::setTouches(simulator, {touch});
      simulator.step(dt);
      const auto envelope = support::frameEnvelope(sensor, touch.placed(objects), support::roundingFor(sensor, touch.placed(objects)),
                                                   previous, static_cast<double>(static_cast<float>(dt)));
      support::expectMatches(simulator.read(), 0, sensor, envelope);
      previous = envelope.penetration;
      touch.X_SO[0].position[2] += random.uniform(-0.3e-3, 0.3e-3);
      touch.X_SO[0].position[0] += random.uniform(-0.3e-3, 0.3e-3);
    }
  }
}

TEST(DampingOnEveryDriver, ClosedFormOnAFlatPunch) {
  const double damping = 2e5, dt = 0.01, area = 3.4e-3 * 3.4e-3;
  const Sensor sensor = support::gridSensor({.num_rows = 1, .num_cols = 1, .law = {1e8, 1, damping}});
  Simulator simulator = support::makeSimulator(sensor, {Object(HalfSpace{})});
  double before = 0;
  bool is_first = true;
  for (const double depth : {0.3e-3, 0.5e-3, 0.5e-3, 0.45e-3, 0.1e-3, 0.0, 0.2e-3}) {
    simulator.setObjects(std::vector<int>{0}, std::vector<Pose>{{.position = {0, 0, -depth}}});
    simulator.step(dt);
    const double rate = is_first ? 0 : (depth - before) / dt;
    const double expected = depth > 0 ? std::max(0.0, 1e8 * depth + damping * rate) * area : 0;
    const double slack = (1e8 + 2 * damping / dt) * support::kMarginZ * area + support::kAbsoluteForce;
    EXPECT_NEAR(simulator.read().ground_truth.total_force[0], expected, slack);
    before = depth;
    is_first = false;
  }
}

// Skin that an object has left is at full height again, so that it is pressed anew by an object that returns after a step elsewhere.
TEST(DampingOnEveryDriver, ForgetsTheDepthOfTaxelsThatTheObjectHasLeft) {
  constexpr double kStiffness = 1e8, kDamping = 2e5, kDt = 0.01, kDepth = 0.4e-3, kAway = 8e-3;
  const Sensor sensor = support::gridSensor({.law = {kStiffness, 1, kDamping}});
  Simulator simulator = support::makeSimulator(sensor, {Object(Box{{3e-3, 3e-3, 3e-3}})});
  std::vector<double> forces;
  for (const double x : {-kAway, kAway, -kAway, -kAway}) {
    forces.push_back(support::stepOnce(simulator, {{{0}, {{.position = {x, 0, 1.5e-3 - kDepth}}}}}, kDt).ground_truth.total_force[0]);
  }
  const double at_rest = forces[0];  // the first step after a reset has no rate
  ASSERT_GT(at_rest, 0);
  const double pressed_anew = at_rest * (1 + kDamping / (kStiffness * kDt));
  // A float32 pose is off by its rounding, once in the depth and once in its rate.
  const double slack = at_rest * (1 + 2 * kDamping / (kStiffness * kDt)) * support::kMarginZ / kDepth;
  EXPECT_NEAR(forces[1], pressed_anew, slack);
  EXPECT_NEAR(forces[2], pressed_anew, slack);
  EXPECT_NEAR(forces[3], at_rest, slack);
}

TEST(FrameRateOnEveryDriver, HoldsMeasuredValuesBetweenFrames) {
  constexpr int kStepsPerFrame = 10, kNumSteps = 100;
  Sensor sensor = support::gridSensor();
  sensor.readout.curve = {1000};
  sensor.frame_rate = 100;
  Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{0.008})});
  std::vector<std::uint32_t> held;
  std::vector<int> updates;
  double last_truth = -1;
  for (int step = 0; step < kNumSteps; ++step) {
    const double depth = 0.2e-3 + 1e-5 * step;  // a new image at every step
    const FrameView frame =
        support::stepOnce(simulator, {{{0}, {{.position = {0, 0, 0.008 - depth}}}}}, 1.0 / (sensor.frame_rate * kStepsPerFrame));
    const std::vector<std::uint32_t> measured = support::measuredBitsOf(frame, 0, 1);
    if (measured != held) {
      updates.push_back(step);
    }
    held = measured;
    EXPECT_GT(frame.ground_truth.total_force[0], last_truth) << "ground truth is not held";
    last_truth = frame.ground_truth.total_force[0];
  }
  ASSERT_FALSE(updates.empty());
  EXPECT_EQ(updates.front(), 0);  // a frame that is gone cannot be held
  // The first frame may come before the clock's own first tick; from then on frames are evenly spaced, whatever the clock rounds to.
  ASSERT_GE(updates.size(), static_cast<std::size_t>(kNumSteps / kStepsPerFrame));
  for (std::size_t n = 2; n < updates.size(); ++n) {
    EXPECT_EQ(updates[n] - updates[n - 1], kStepsPerFrame);
  }
}

TEST(FrameRateOnEveryDriver, NewFrameEqualsAFrameWithoutHold) {
  Sensor held = support::gridSensor(), free = support::gridSensor();
  held.readout.curve = free.readout.curve = {1000};
  held.frame_rate = 50;
  const std::vector<Object> objects{Object(Sphere{0.008})};
  const Model held_model(support::sharedDevice(), {.sensor = held, .objects = objects});
  const Model free_model(support::sharedDevice(), {.sensor = free, .objects = objects});
  Simulator a(held_model, {}), b(free_model, {});
  for (Simulator* simulator : {&a, &b}) {
    support::setTouches(*simulator, {{{0}, {{.position = {0, 0, 0.0075}}}}});
    simulator->step(1e-3);
  }
  EXPECT_EQ(support::bitsOf(a.read(), 0, 1), support::bitsOf(b.read(), 0, 1));
}

TEST(FrameRateOnEveryDriver, ResetClearsTheHeldFrameOfOneInstance) {
  Sensor sensor = support::gridSensor();
  sensor.readout.curve = {1000};
  sensor.frame_rate = 10;
  Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{0.008})}, {.num_instances = 2});
  const auto at = [](double depth) { return Touch{{0}, {{.position = {0, 0, 0.008 - depth}}}}; };
  const auto first = support::measuredBitsOf(support::stepOnce(simulator, {at(0.3e-3), at(0.3e-3)}, 1e-3), 0, 2);
  FrameView frame = support::stepOnce(simulator, {at(0.6e-3), at(0.6e-3)}, 1e-3);
  EXPECT_EQ(support::measuredBitsOf(frame, 0, 2), first);
  EXPECT_EQ(support::measuredBitsOf(frame, 1, 2), first);
  simulator.reset(0, 3);
  frame = support::stepOnce(simulator, 1e-3);
  EXPECT_NE(support::measuredBitsOf(frame, 0, 2), first);
  EXPECT_EQ(support::measuredBitsOf(frame, 1, 2), first);
}

TEST(VariationOnEveryDriver, GainScalesTheReadoutUntilTheNextReset) {
  Sensor sensor = support::gridSensor({.num_rows = 1, .num_cols = 1});
  sensor.readout.curve = {1000};
  Simulator simulator = support::makeSimulator(sensor, {Object(HalfSpace{})});
  const double depth = 0.5e-3, force = 1.73e8 * depth * 3.4e-3 * 3.4e-3;
  support::setTouches(simulator, {{{0}, {{.position = {0, 0, -depth}}}}});
  const double slack = 1 + 1000 * 1.73e8 * support::kMarginZ * 3.4e-3 * 3.4e-3;  // a count, and the depth's rounding
  for (const float gain : {1.0f, 0.5f, 1.7f}) {
    simulator.reset(0, 1, {.gain = gain});
    EXPECT_NEAR(support::stepOnce(simulator, 1e-3).tactile_image[0], 1000 * force * gain, slack * gain);
  }
  simulator.reset(0, 1);
  EXPECT_NEAR(support::stepOnce(simulator, 1e-3).tactile_image[0], 1000 * force, slack);
}

// 3000 x - 1000 x^2 counts: saturated from 1 N on, largest at 1.5 N, and below 0 from 3 N on.
TEST(VariationOnEveryDriver, APolynomialThatFallsBeyondItsMaximumStaysSaturated) {
  Sensor sensor = support::gridSensor({.num_rows = 1, .num_cols = 1});
  sensor.readout.curve = {3000, -1000};
  sensor.readout.saturation = 2000;
  Simulator simulator = support::makeSimulator(sensor, {Object(HalfSpace{})});
  const double depth = 0.5e-3, force = 1.73e8 * depth * 3.4e-3 * 3.4e-3;  // 1.0 N
  support::setTouches(simulator, {{{0}, {{.position = {0, 0, -depth}}}}});
  for (const float gain : {0.5f, 1.2f, 2.0f, 4.0f, 100.0f}) {
    simulator.reset(0, 1, {.gain = gain});
    const double x = std::min(gain * force, 1.5);
    EXPECT_NEAR(support::stepOnce(simulator, 1e-3).tactile_image[0], std::min(3000 * x - 1000 * x * x, 2000.0), 2) << gain;
  }
}

TEST(VariationOnEveryDriver, NoiseAndGainSpreadHaveTheirStandardDeviations) {
  constexpr int kSide = 64, kNumTaxels = kSide * kSide;
  Sensor sensor = support::gridSensor({.num_rows = kSide, .num_cols = kSide, .pitch_x = 1e-3, .pitch_y = 1e-3, .samples_per_taxel = 1});
  sensor.readout.adc_bits = 16;
  sensor.readout.saturation = 65535;
  sensor.readout.curve = {1e5};
  sensor.readout.noise = 30;
  Simulator simulator = support::makeSimulator(sensor, {Object(HalfSpace{})}, {.num_instances = 2, .seed = 9});
  support::setTouches(simulator, {{{0}, {{.position = {0, 0, -1e-3}}}}, {{0}, {{.position = {0, 0, -1e-3}}}}});  // 0.173 N, 17300 counts
  simulator.reset(0, 0, {.noise = 40});
  simulator.reset(1, 1, {.gain_spread = 0.1f});
  const FrameView frame = support::stepOnce(simulator, 1e-3);
  double mean[2] = {0, 0}, variance[2] = {0, 0};
  const auto valueOf = [&](int i, int t) {
    const double counts = frame.tactile_image[i * kNumTaxels + t];
    return i == 0 ? counts : std::log(counts / 17300);
  };
  for (int i = 0; i < 2; ++i) {
    for (int t = 0; t < kNumTaxels; ++t) {
      mean[i] += valueOf(i, t) / kNumTaxels;
    }
    for (int t = 0; t < kNumTaxels; ++t) {
      variance[i] += std::pow(valueOf(i, t) - mean[i], 2) / (kNumTaxels - 1);
    }
  }
  // Five standard errors: of a mean sigma / 64, of a standard deviation sigma / sqrt(2 4096) = sigma / 90.5.
  const double sigma = 50;  // 30 and 40 in quadrature
  EXPECT_NEAR(mean[0], 17300, 5 * sigma / 64 + 17300 * support::kMarginZ / 1e-3);
  EXPECT_NEAR(std::sqrt(variance[0]), sigma, 5 * sigma / 90.5);
  EXPECT_NEAR(mean[1], 0, 5 * 0.1 / 64 + support::kMarginZ / 1e-3);
  EXPECT_NEAR(std::sqrt(variance[1]), 0.1, 5 * 0.1 / 90.5);
}

TEST(VariationOnEveryDriver, NoiseChangesEveryFrameAndIsOptional) {
  Sensor sensor = support::gridSensor();
  sensor.readout.curve = {1000};
  Simulator simulator = support::makeSimulator(sensor, {Object(HalfSpace{})});
  support::setTouches(simulator, {{{0}, {{.position = {0, 0, -1e-3}}}}});
  const auto next = [&] { return support::measuredBitsOf(support::stepOnce(simulator, 1e-3), 0, 1); };
  EXPECT_EQ(next(), next());
  simulator.reset(0, 4, {.noise = 20});
  const auto first = next(), second = next();
  EXPECT_NE(first, second);
  simulator.reset(0, 4, {.noise = 20});
  EXPECT_EQ(next(), first);  // the same episode, the same noise
  EXPECT_EQ(next(), second);
}

}  // namespace
}  // namespace taxelsim
