// Stage 4 on the device: closed forms under a flat punch, and the twin over random parameters and paths.
#include "reference/lag.h"

#include "reference/readout.h"
#include "simulation/comparison.h"
#include "support/cases.h"
#include "support/input_error.h"
#include "support/random_scene.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using support::Random;

constexpr double kCountsPerNewton = 20'000;
// Error of the closed forms themselves; one count of 20,000 is far less.
constexpr double kClosedForm = 0.005;

// One taxel of 2 N per mm of depth under a flat punch.
Sensor punchedSensor() {
  Sensor sensor = support::gridSensor({.num_rows = 1, .num_cols = 1, .samples_per_taxel = 1});
  sensor.readout.curve = {kCountsPerNewton};
  sensor.readout.adc_bits = 16;
  sensor.readout.curve_limit = 0;
  sensor.readout.saturation = 65535;
  return sensor;
}

class Punch {
 public:
  explicit Punch(const Sensor& sensor)
      : model_(support::sharedDevice(), {.sensor = sensor, .objects = {Object(HalfSpace{})}}), simulator_(model_, {}) {}

  // Holds the punch at a depth (m) for a step of dt (s).
  void step(double depth, double dt) {
    const FrameView frame = support::stepOnce(simulator_, {{{0}, {{.position = {0, 0, -depth}}}}}, dt);
    counts = frame.tactile_image[0];
    shown = counts / kCountsPerNewton;
    force = frame.ground_truth.tactile_normal_force[0];
  }
  void reset() { simulator_.reset(0, 1); }

  double force = 0;  // N, clean
  double shown = 0;  // N, measured
  std::uint32_t counts = 0;

 private:
  Model model_;
  Simulator simulator_;
};

TEST(LagOnEveryDriver, CreepAtConstantForce) {
  Sensor sensor = punchedSensor();
  sensor.readout.creep = {{0.15, 0.5}, {0.1, 9}};
  Punch punch(sensor);
  for (int n = 1; n <= 600; ++n) {
    punch.step(1e-3, 0.02);
    const double t = 0.02 * n;
    const double expected = punch.force * (1 + 0.15 * (1 - std::exp(-t / 0.5)) + 0.1 * (1 - std::exp(-t / 9)));
    ASSERT_NEAR(punch.shown, expected, kClosedForm * expected) << "after " << t << " s";
  }
}

TEST(LagOnDevice, LowPassStepResponse) {
  Sensor sensor = punchedSensor();
  sensor.readout.low_pass_time = 0.1;
  Punch punch(sensor);
  for (int n = 1; n <= 100; ++n) {
    punch.step(1e-3, 0.01);
    const double expected = punch.force * (1 - std::exp(-0.01 * n / 0.1));
    ASSERT_NEAR(punch.shown, expected, kClosedForm * expected);
  }
}

TEST(LagOnEveryDriver, HysteresisLoopArea) {
  Sensor sensor = punchedSensor();
  const double strength = 0.3, width = 0.25;
  sensor.readout.hysteresis_strength = {strength};
  sensor.readout.hysteresis_width = {width};
  Punch punch(sensor);
  // Depths of a closed path; the first rise only leads to it.
  const auto depth = [](int n) { return 1e-3 * (n % 200 < 100 ? n % 200 : 200 - n % 200) / 100; };
  for (int n = 0; n <= 100; ++n) punch.step(depth(n), 0.01);
  const double amplitude = punch.force / 2;
  double area = 0;
  for (int n = 101; n <= 300; ++n) {
    const double force_before = punch.force, shown_before = punch.shown;
    punch.step(depth(n), 0.01);
    area -= (punch.force - force_before) * (punch.shown + shown_before) / 2;
  }
  const double expected = 4 * strength * width * (amplitude - width);
  EXPECT_NEAR(area, expected, kClosedForm * expected);
}

TEST(LagOnEveryDriver, HysteresisKeepsTurningPoints) {
  Sensor sensor = punchedSensor();
  sensor.readout.hysteresis_strength = {0.2, 0.3};
  sensor.readout.hysteresis_width = {0.1, 0.6};
  Punch punch(sensor);
  for (const double depth : {0.3e-3, 1.2e-3}) punch.step(depth, 0.01);
  const std::uint32_t before = punch.counts;
  for (const double depth : {0.9e-3, 1.0e-3, 0.7e-3, 1.2e-3}) punch.step(depth, 0.01);
  EXPECT_EQ(punch.counts, before);
}

TEST(LagOnDevice, DelayShiftsByWholeSteps) {
  for (const int num_steps : {1, 5, kMaxDelaySteps}) {
    Sensor sensor = punchedSensor();
    sensor.readout.delay = 0.01 * num_steps;
    Punch punch(sensor);
    for (int round = 0; round < 2; ++round) {  // the second one begins with a full ring
      std::vector<double> forces;
      for (int n = 0; n < 50; ++n) {
        punch.step(1e-5 * (n + 1), 0.01);
        forces.push_back(punch.force);
        const double expected = n < num_steps ? 0 : forces[static_cast<std::size_t>(n - num_steps)];
        ASSERT_NEAR(punch.shown, expected, 1 / kCountsPerNewton) << num_steps << " steps, in step " << n;
      }
      punch.reset();
    }
  }
}

TEST(LagOnDevice, RejectsADelayOfTooManySteps) {
  Sensor sensor = punchedSensor();
  sensor.readout.delay = 0.32;
  Simulator simulator = support::makeSimulator(sensor, {Object(HalfSpace{})});
  support::stepOnce(simulator, 0.01);
  EXPECT_EQ(support::inputError([&] { simulator.step(0.0099); }),
            "readout.delay: 0.32 is not allowed: s, at most 32 steps of 0.0099 s (0.3168 s); shorten it or take longer steps");
  simulator.step(0.01);  // a refusal changes nothing
  simulator.read();
}

// State advances between frames: a held frame shows the value of a sensor without hold at that step.
TEST(LagOnEveryDriver, StateAdvancesBetweenHeldFrames) {
  Sensor free = punchedSensor();
  free.readout.creep = {{0.5, 0.05}};
  free.readout.hysteresis_strength = {0.2};
  free.readout.hysteresis_width = {0.1};
  free.readout.low_pass_time = 0.02;
  free.readout.delay = 3e-3;
  Sensor held = free;
  held.frame_rate = 100;
  Punch a(free), b(held);
  std::uint32_t last = 0;
  for (int n = 0; n < 50; ++n) {
    const double depth = 1e-3 * std::abs(std::sin(0.1 * n));
    a.step(depth, 1e-3);
    b.step(depth, 1e-3);
    if (n % 10 == 0) last = a.counts;
    EXPECT_EQ(b.counts, last) << "step " << n;
  }
}

// After contact ends the reading decays by the closed form.
TEST(LagOnEveryDriver, StateAdvancesAfterContactEnds) {
  Sensor sensor = support::gridSensor();
  sensor.readout = punchedSensor().readout;
  sensor.readout.low_pass_time = 0.05;
  Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{0.004})});
  simulator.setObjects(std::vector<int>{0}, std::vector<Pose>{{.position = {0, 1.7e-3, 0.003}}});
  for (int n = 0; n < 100; ++n) {
    support::stepOnce(simulator, 0.01);
  }
  const std::span<const std::uint32_t> image = simulator.read().tactile_image;
  const std::vector<std::uint32_t> settled(image.begin(), image.end());
  const auto touched = static_cast<std::size_t>(std::max_element(settled.begin(), settled.end()) - settled.begin());
  ASSERT_GT(settled[touched], 1000u);
  simulator.setObjects(std::vector<int>{0}, std::vector<Pose>{{.position = {0.009, -0.02, 0.003}}});
  for (int n = 1; n <= 20; ++n) {
    ASSERT_NEAR(support::stepOnce(simulator, 0.01).tactile_image[touched], settled[touched] * std::exp(-0.01 * n / 0.05), 1.5)
        << "counts, in step " << n;
  }
}

// ---- against the twin ----

Readout randomLag(Random& random, Readout readout) {
  for (int e = random.integer(0, kMaxHysteresisElements); e > 0; --e) {
    readout.hysteresis_strength.push_back(random.uniform(0, 0.24));
    readout.hysteresis_width.push_back(random.uniform(0, 0.02));
  }
  for (int m = random.integer(0, kMaxCreepTerms); m > 0; --m) readout.creep.push_back({random.uniform(0, 0.5), random.uniform(0.005, 2)});
  if (random.chance(0.5)) readout.low_pass_time = random.uniform(0.001, 0.3);
  if (random.chance(0.5)) readout.delay = random.uniform(0, 0.1);
  return readout;
}

class LagSeeds : public ::testing::TestWithParam<int> {};

// The twin's stages 4 and 5 take the device's own spread force, so only their rounding remains: at most three roundings of the largest
// force so far per step, and about forty of the readout.
TEST_P(LagSeeds, CountsFollowTheTwin) {
  Random random(static_cast<std::uint64_t>(GetParam()));
  Sensor sensor = support::randomSensor(random, {.max_rows = 6, .max_cols = 7, .max_patches = 1 + GetParam() % 2, .max_kernel = 5});
  sensor.readout = randomLag(random, sensor.readout);
  sensor.readout.adc_bits = 16;
  sensor.readout.curve_limit = 0;
  sensor.readout.saturation = 65535;
  if (sensor.readout.curve_points.empty()) sensor.readout.curve[0] *= 65535.0 / 256;
  for (CurvePoint& point : sensor.readout.curve_points) point.counts *= 65535.0 / 256;
  if (random.chance(0.5)) sensor.frame_rate = random.uniform(30, 300);
  const std::vector<Object> objects{Object(HalfSpace{})};
  const int workgroups[] = {0, 8, 64};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects, .image_workgroup = workgroups[random.integer(0, 2)]});
  constexpr int kNumInstances = 2, kNumSteps = 60;
  Simulator simulator(model, {.num_instances = kNumInstances});
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  double creep = 1;
  for (const CreepTerm& term : sensor.readout.creep) creep += term.fraction;
  std::vector<reference::Lag> lags(kNumInstances, reference::Lag(sensor.readout, num_taxels));
  std::vector<std::vector<std::uint32_t>> last(kNumInstances, std::vector<std::uint32_t>(num_taxels, 0));
  std::vector<Quaternion> R_SO;
  for (int i = 0; i < kNumInstances; ++i) R_SO.push_back(random.tilt(0.05));
  const double amplitude = random.uniform(0.2, 0.5) * sensor.skin.thickness;
  double peak = 0;  // N
  std::size_t num_checked = 0;
  for (int step = 0; step < kNumSteps; ++step) {
    std::vector<Pose> X_SO;
    for (int i = 0; i < kNumInstances; ++i) X_SO.push_back({{0, 0, amplitude * (std::sin(0.2 * step + i) - 0.8)}, R_SO[i]});
    if (step == 40) {
      simulator.reset(1, 5);
      lags[1] = reference::Lag(sensor.readout, num_taxels);
    }
    const double dt = random.uniform(0.004, 0.02);
    simulator.setObjects(std::vector<int>(kNumInstances, 0), X_SO);
    const FrameView frame = support::stepOnce(simulator, dt);
    for (std::size_t i = 0; i < kNumInstances; ++i) {
      const auto force = frame.ground_truth.tactile_normal_force.subspan(i * num_taxels, num_taxels);
      const auto counts = frame.tactile_image.subspan(i * num_taxels, num_taxels);
      const std::vector<double> lagged = lags[i].step(std::vector<double>(force.begin(), force.end()), dt);
      peak = std::max<double>(peak, *std::max_element(force.begin(), force.end()));
      const bool is_held = std::equal(counts.begin(), counts.end(), last[i].begin());
      last[i].assign(counts.begin(), counts.end());
      if (sensor.frame_rate > 0 && is_held) continue;
      const double slack = (3 * kNumSteps + 40) * support::kUlp * creep * peak;
      for (std::size_t t = 0; t < num_taxels; ++t) {
        const double gain = reference::gainOf(sensor.readout, t), trigger = reference::triggerOf(sensor.readout, t);
        const auto counts_at = [&](double x) {
          const double value = reference::analogueOutput(sensor.readout, x, gain, trigger, 0);
          return std::clamp(std::round(value), 0.0, static_cast<double>(sensor.readout.saturation));
        };
        ASSERT_GE(counts[t], counts_at(lagged[t] - slack)) << "taxel " << t << " of instance " << i << " in step " << step;
        ASSERT_LE(counts[t], counts_at(lagged[t] + slack)) << "taxel " << t << " of instance " << i << " in step " << step;
        num_checked += counts[t] > 0;
      }
    }
  }
  EXPECT_GT(num_checked, 0u) << "nothing was touched";
}

INSTANTIATE_TEST_SUITE_P(OnEveryDriver, LagSeeds, support::seeds(4, 12));

// ---- extreme parameters ----

TEST(LagOnDevice, ExtremeParametersStayFinite) {
  const std::vector<std::pair<const char*, std::function<void(Readout&, double)>>> keys = {
      {"hysteresis_width", [](Readout& r, double f) { r.hysteresis_strength = {0.5}, r.hysteresis_width = {0.1 * f}; }},
      {"hysteresis_strength",
       [](Readout& r, double f) { r.hysteresis_strength = {f < 1 ? 0.1 * f : 1 - 1e-9}, r.hysteresis_width = {0.1}; }},
      {"creep.fraction",
       [](Readout& r, double f) {
         r.creep = {{std::min(0.1 * f, kMaxCreepFraction), 1}};
       }},
      {"creep.time",
       [](Readout& r, double f) {
         r.creep = {{0.1, f}};
       }},
      {"low_pass_time", [](Readout& r, double f) { r.low_pass_time = 0.01 * f; }},
      {"delay", [](Readout& r, double f) { r.delay = std::min(0.01 * f, 0.32); }},
      {"bias", [](Readout& r, double f) { r.bias = 10 * f; }},
      {"random_walk", [](Readout& r, double f) { r.random_walk = 10 * f; }},
      {"gain_spread", [](Readout& r, double f) { r.gain_spread = std::min(0.1 * f, kMaxGainSpread); }},
      {"press_gain_spread", [](Readout& r, double f) { r.press_gain_spread = std::min(0.1 * f, kMaxGainSpread); }},
      {"dead_taxel_probability", [](Readout& r, double f) { r.dead_taxel_probability = std::min(0.1 * f, 1.0); }}};
  for (const auto& [name, set] : keys) {
    for (const double factor : {1e-6, 1e6}) {
      SCOPED_TRACE(std::string(name) + " x " + std::to_string(factor));
      Sensor sensor = support::gridSensor({.num_rows = 3, .num_cols = 3, .samples_per_taxel = 1});
      sensor.readout.curve = {1000};
      set(sensor.readout, factor);
      Simulator simulator = support::makeSimulator(sensor, {Object(HalfSpace{})});
      for (int n = 0; n < 4; ++n) {
        const FrameView frame = support::stepOnce(simulator, {{{0}, {{.position = {0, 0, -0.5e-3 * (n % 2)}}}}}, 0.01);
        support::expectWellFormed(frame, sensor, 1);
        EXPECT_LE(*std::max_element(frame.tactile_image.begin(), frame.tactile_image.end()), 4095u);
      }
    }
  }
}

}  // namespace
}  // namespace taxelsim
