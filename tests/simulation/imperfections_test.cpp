// Imperfections of stage 5 on the device: the twin's draws taxel by taxel, independence of batch, slot and workgroup, and no effect when
// off.
#include "reference/imperfections.h"

#include "reference/lag.h"
#include "simulation/comparison.h"
#include "support/curved_sensor.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Touch;

constexpr double kDt = 0.01;  // s
constexpr std::uint64_t kSeed = 77;

// All effects of stages 4 and 5.
Sensor busySensor(int num_patches) {
  Sensor sensor = support::gridSensor({.num_rows = 5, .num_cols = 7, .samples_per_taxel = 3});
  for (int p = 1; p < num_patches; ++p) {
    support::addPatch(sensor, {{0.02, 0, 0}, axisAngle({0, 1, 0}, 0.1)});
  }
  sensor.psf = gaussianPsf(0.5, 3);
  Readout& readout = sensor.readout;
  readout.adc_bits = 14;
  readout.saturation = 16383;
  readout.curve = {3000, 100};
  readout.output_scale = 2;
  readout.trigger = 0.01;
  readout.noise = 5;
  readout.hysteresis_strength = {0.1, 0.2};
  readout.hysteresis_width = {0.01, 0.05};
  readout.creep = {{0.1, 0.02}, {0.2, 0.5}};
  readout.low_pass_time = 0.015;
  readout.delay = 0.02;
  readout.bias = 20;
  readout.random_walk = 60;
  readout.gain_spread = 0.1;
  readout.press_gain_spread = 0.2;
  readout.dead_taxel_probability = 0.1;
  return sensor;
}

const std::vector<Object>& objects() {
  static const std::vector<Object> kObjects{Object(HalfSpace{}), Object(Sphere{0.01})};
  return kObjects;
}

// Step `n` of the episode; no two alike.
Touch touchOf(std::uint64_t episode, int n) {
  const double depth = 1e-4 * (2 + static_cast<double>(episode % 5) + n);
  return episode % 2 == 0 ? Touch{{0}, {{.position = {0, 0, -depth}}}} : Touch{{1}, {{.position = {1e-3 * n, 0, 0.01 - depth}}}};
}

// Simulates `num_steps` of the given episodes, one per instance. Returns the bits of each after the last.
std::vector<std::vector<std::uint32_t>> bitsOfEpisodes(Simulator& simulator, const std::vector<std::uint64_t>& episodes, int num_steps) {
  const int num_instances = static_cast<int>(episodes.size());
  for (int i = 0; i < num_instances; ++i) simulator.reset(i, episodes[i], {.gain = 1.1f, .gain_spread = 0.05f, .noise = 2});
  for (int n = 0; n < num_steps; ++n) {
    std::vector<Touch> touches;
    for (const std::uint64_t episode : episodes) touches.push_back(touchOf(episode, n));
    support::expectWellFormed(support::stepOnce(simulator, touches, kDt), simulator.model().sensor(), num_instances);
  }
  const FrameView frame = simulator.read();
  return support::bitsOfAll(frame, num_instances);
}

// A normal number is sqrt(-2 log u) cos(angle): Vulkan lets a driver's cos be off by 2^-11, and the root is at most 5.8.
constexpr double kDraw = 3e-3;
// Float32 rounding of everything else.
constexpr double kRounded = 1e-5;

TEST(ImperfectionsOnEveryDriver, CountsMatchTheTwin) {
  for (const int num_patches : {1, 2, 60}) {  // 60 and more: taxels with places of their own
    Sensor sensor = busySensor(num_patches < 60 ? num_patches : 1);
    if (num_patches == 60) {
      sensor.patches = support::sphereFingertip(8e-3, 2, 1.2).patches;
      sensor.psf = {.sigma = 1e-3};
    }
    if (num_patches == 2) {
      // The first piece is so flat that bias lifts some taxels without contact above 0, on its extension below 0.
      sensor.readout.curve = {1};
      sensor.readout.curve_points = {{0.05, 40}, {0.2, 700}, {1, 3500}};
      sensor.readout.trigger = 0.02;
    }
    const std::uint32_t steps_per_frame = num_patches == 1 ? 1 : 2;
    sensor.frame_rate = num_patches == 1 ? 0 : 0.5 / kDt;
    const Readout& readout = sensor.readout;
    Simulator simulator = support::makeSimulator(sensor, objects(), {.seed = kSeed});
    const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
    int num_dead = 0, num_read = 0;
    for (std::uint64_t episode = 40; episode < 44; ++episode) {
      simulator.reset(0, episode, {.gain = 1.1f, .gain_spread = 0.05f, .noise = 2});
      reference::Lag lag(readout, num_taxels);
      reference::Imperfections imperfections(readout, num_taxels,
                                             {.seed = kSeed, .episode = episode, .gain = 1.1, .gain_spread = 0.05, .noise = 2});
      for (std::uint32_t n = 0; n < 8; ++n) {
        support::setTouches(simulator, {touchOf(episode, static_cast<int>(n))});
        simulator.step(kDt);
        imperfections.step(kDt);
        const FrameView frame = simulator.read();
        const auto truth = frame.ground_truth.tactile_normal_force;
        const std::vector<double> force = lag.step(std::vector<double>(truth.begin(), truth.end()), kDt);
        if (n % steps_per_frame != 0) continue;  // held
        const reference::ReadoutDraw draw = imperfections.draw(n / steps_per_frame);
        for (std::size_t t = 0; t < num_taxels; ++t) {
          const double value = reference::analogueOutput(readout, force[t], draw.gain[t], readout.trigger, draw.noise[t]);
          const double slack = kDraw * (readout.bias + readout.noise + readout.random_walk) +
                               (kRounded + kDraw * std::hypot(readout.gain_spread, 0.05)) *
                                   reference::analogueOutput(readout, force[t], draw.gain[t], -readout.trigger, 0);
          const auto clip = [&](double v) { return draw.dead[t] ? 0 : std::clamp(std::round(v), 0.0, 1.0 * readout.saturation); };
          ASSERT_GE(frame.tactile_image[t], clip(value - slack)) << "taxel " << t << ", step " << n;
          ASSERT_LE(frame.tactile_image[t], clip(value + slack)) << "taxel " << t << ", step " << n;
          num_dead += draw.dead[t];
          num_read += frame.tactile_image[t] > 0;
        }
      }
    }
    EXPECT_GT(num_dead, 0);
    EXPECT_GT(num_read, 50);
  }
}

TEST(ImperfectionsOnEveryDriver, EpisodeIndependentOfBatchAndSlot) {
  constexpr int kNumSteps = 5;
  const Model model(support::sharedDevice(), {.sensor = busySensor(1), .objects = objects()});
  const std::vector<std::uint64_t> episodes{3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13}, backwards(episodes.rbegin(), episodes.rend());
  const int num_instances = static_cast<int>(episodes.size());
  Simulator batch(model, {.num_instances = num_instances, .seed = kSeed});
  const auto expected = bitsOfEpisodes(batch, episodes, kNumSteps);
  const auto again = bitsOfEpisodes(batch, backwards, kNumSteps);  // in slots that others have used
  Simulator alone(model, {.seed = kSeed});
  for (int i = 0; i < num_instances; ++i) {
    EXPECT_EQ(again[num_instances - 1 - i], expected[i]) << "episode " << episodes[i];
    EXPECT_EQ(bitsOfEpisodes(alone, {episodes[i]}, kNumSteps)[0], expected[i]) << "episode " << episodes[i];
  }
  EXPECT_NE(expected[0], expected[2]);
}

TEST(ImperfectionsOnEveryDriver, IndependentOfWorkgroupSize) {
  const auto bits = [&](int image_workgroup, int num_patches) {
    const Model model(support::sharedDevice(),
                      {.sensor = busySensor(num_patches), .objects = objects(), .image_workgroup = image_workgroup});
    Simulator simulator(model, {.num_instances = 5, .seed = kSeed});
    return bitsOfEpisodes(simulator, {3, 4, 5, 6, 7}, 4);
  };
  for (const int num_patches : {1, 2}) {
    const auto expected = bits(0, num_patches);
    for (const int workgroup : {4, 16, 128}) EXPECT_EQ(bits(workgroup, num_patches), expected) << workgroup;
  }
}

// Reset of one instance does not change the state of others.
TEST(ImperfectionsOnEveryDriver, ResetAffectsOneInstance) {
  const Model model(support::sharedDevice(), {.sensor = busySensor(1), .objects = objects()});
  Simulator undisturbed(model, {.num_instances = 2, .seed = kSeed}), disturbed(model, {.num_instances = 2, .seed = kSeed});
  for (int n = 0; n < 6; ++n) {
    if (n == 3) disturbed.reset(0, 9);
    for (Simulator* simulator : {&undisturbed, &disturbed}) {
      support::setTouches(*simulator, {touchOf(0, n), touchOf(1, n)});
      simulator->step(kDt);
    }
    const FrameView a = undisturbed.read(), b = disturbed.read();
    EXPECT_EQ(support::bitsOf(a, 1, 2), support::bitsOf(b, 1, 2)) << "step " << n;
    EXPECT_EQ(support::measuredBitsOf(a, 0, 2) == support::measuredBitsOf(b, 0, 2), n < 3) << "step " << n;
  }
}

// `bias` in counts, `random_walk` in counts / sqrt(s).
void expectOffsetsEverywhere(double bias, double random_walk) {
  constexpr int kSide = 64, kNumTaxels = kSide * kSide;
  Sensor sensor = support::gridSensor({.num_rows = kSide, .num_cols = kSide, .pitch_x = 1e-3, .pitch_y = 1e-3, .samples_per_taxel = 1});
  sensor.readout.adc_bits = 16;
  sensor.readout.saturation = 65535;
  sensor.readout.bias = bias;
  sensor.readout.random_walk = random_walk;
  Simulator simulator = support::makeSimulator(sensor, {Object(HalfSpace{})}, {.seed = 9});
  for (int n = 0; n < 10; ++n) {
    const FrameView frame = support::stepOnce(simulator, 1e-3);
    // Negative values are cut to 0: over all taxels the mean is sigma / sqrt(2 pi), the mean square sigma^2 / 2.
    const double variance = bias * bias + random_walk * random_walk * 1e-3 * (n + 1);
    double mean = 0, square = 0;
    for (const std::uint32_t counts : frame.tactile_image) {
      mean += counts / static_cast<double>(kNumTaxels);
      square += static_cast<double>(counts) * counts / kNumTaxels;
    }
    // Five standard errors: the variance of the cut value is sigma^2 (1/2 - 1/(2 pi)), of its square sigma^4 (3/2 - 1/4); plus half a count
    // of rounding.
    EXPECT_NEAR(mean, std::sqrt(variance / (2 * std::numbers::pi)), 5 * std::sqrt(variance * 0.3408 / kNumTaxels) + 0.5);
    EXPECT_NEAR(square, variance / 2, 5 * variance * std::sqrt(1.25 / kNumTaxels) + std::sqrt(variance));
    EXPECT_EQ(frame.ground_truth.total_force[0], 0);
  }
}

TEST(ImperfectionsOnEveryDriver, BiasAndWalkAffectTaxelsWithoutContact) {
  expectOffsetsEverywhere(300, 0);
  expectOffsetsEverywhere(0, 4000);
  expectOffsetsEverywhere(300, 4000);
}

// ---- off ----

// Values of all per-taxel arrays, without moments, which are summed about another taxel if everything is computed.
std::vector<std::uint32_t> arraysOf(const FrameView& frame) {
  std::vector<std::uint32_t> bits(frame.tactile_image.begin(), frame.tactile_image.end());
  for (const float force : frame.ground_truth.tactile_normal_force) bits.push_back(std::bit_cast<std::uint32_t>(force));
  return bits;
}

// The smallest setting that is still computed changes no bit of the image.
TEST(ImperfectionsOnEveryDriver, TinyImperfectionsChangeNoCount) {
  Sensor plain = support::gridSensor();
  plain.psf = gaussianPsf(0.5, 3);
  plain.readout.curve = {1000};
  const std::vector<std::function<void(Readout&)>> settings = {[](Readout& r) { r.hysteresis_strength = {0.5}, r.hysteresis_width = {0}; },
                                                               [](Readout& r) { r.hysteresis_strength = {0}, r.hysteresis_width = {0.5}; },
                                                               [](Readout& r) {
                                                                 r.creep = {{0, 1}};
                                                               },
                                                               [](Readout& r) { r.low_pass_time = 1e-9; },
                                                               [](Readout& r) { r.bias = 1e-12; },
                                                               [](Readout& r) { r.random_walk = 1e-12; },
                                                               [](Readout& r) { r.gain_spread = 1e-12; },
                                                               [](Readout& r) { r.press_gain_spread = 1e-12; },
                                                               [](Readout& r) { r.dead_taxel_probability = 1e-12; }};
  const auto run = [&](const Sensor& sensor) {
    Simulator simulator = support::makeSimulator(sensor, objects(), {.seed = kSeed});
    std::vector<std::uint32_t> bits;
    for (int n = 0; n < 3; ++n) {
      const std::vector<std::uint32_t> more = arraysOf(support::stepOnce(simulator, {touchOf(1, n)}, kDt));
      bits.insert(bits.end(), more.begin(), more.end());
    }
    return bits;
  };
  const auto expected = run(plain);
  for (std::size_t s = 0; s < settings.size(); ++s) {
    Sensor sensor = plain;
    settings[s](sensor.readout);
    EXPECT_EQ(run(sensor), expected) << "setting " << s;
  }
}

// Ground truth is that of a sensor without imperfections.
TEST(ImperfectionsOnEveryDriver, GroundTruthStaysClean) {
  Sensor busy = busySensor(1), plain = busy;
  plain.readout = {};
  plain.readout.trigger = busy.readout.trigger;
  std::vector<std::vector<float>> forces, wrenches;
  for (const Sensor& sensor : {busy, plain}) {
    Simulator simulator = support::makeSimulator(sensor, objects(), {.seed = kSeed});
    for (int n = 0; n < 3; ++n) {
      support::stepOnce(simulator, {touchOf(1, n)}, kDt);
    }
    const GroundTruthView truth = simulator.read().ground_truth;
    forces.emplace_back(truth.tactile_normal_force.begin(), truth.tactile_normal_force.end());
    wrenches.emplace_back(truth.contact_wrench.begin(), truth.contact_wrench.end());
  }
  EXPECT_EQ(forces[0], forces[1]);
  EXPECT_EQ(wrenches[0], wrenches[1]);
}

}  // namespace
}  // namespace taxelsim
