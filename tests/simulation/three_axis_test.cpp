// Electronics of three-axis taxels on the device: against the double-precision twin, which reads the forces of the same frames, and closed
// forms.
#include "reference/three_axis.h"
#include "simulation/comparison.h"
#include "support/input_error.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Touch;

constexpr double kDt = 0.01;  // s
constexpr int kNumSteps = 6;
constexpr std::uint64_t kSeed = 11, kEpisode = 5;
// float32 on forces and gains, and 2e-6 of a standard deviation for normal numbers: a count, where rounding falls on the other side.
constexpr double kRelative = 8e-7, kOneCount = 1;

const ThreeAxisReadout kAxes{.gain = {{{900, 40, -60}, {-30, 850, 55}, {25, -20, 700}}},
                             .noise = {3, 4, 5},
                             .hysteresis_strength = {0.2, 0.3, 0.1},
                             .hysteresis_width = {0.01, 0.02, 0.05}};

Sensor frictionSensor(const ThreeAxisReadout& axes) {
  Sensor sensor = support::gridSensor({.num_rows = 5, .num_cols = 6, .samples_per_taxel = 3});
  sensor.skin = {.thickness = 3e-3, .law = Winkler{.normal_contact_stiffness = 1.5e8}, .friction = {1e9, 0.5}};
  sensor.psf = gaussianPsf(0.6, 3);
  for (int t = 0; t < numTaxels(sensor); ++t) sensor.readout.taxel_gain.push_back(0.6 + 0.02 * t);
  sensor.readout.three_axis = axes;
  return sensor;
}

const std::vector<Object>& objects() {
  static const std::vector<Object> kObjects{Object(Sphere{0.012})};
  return kObjects;
}

// A sphere that sinks, slides, and rises again.
Touch touchAt(int step) {
  const double depth = 3e-4 + 1e-4 * std::min(step, 6 - step);
  return {{0}, {{.position = {3e-4 * step, -2e-4 * step, 0.012 - depth}}}};
}

// The frame after steps `begin` to `end` of that path, of all instances.
FrameView follow(Simulator& simulator, int num_instances, int begin, int end) {
  FrameView frame;
  for (int n = begin; n < end; ++n) {
    frame = support::stepOnce(simulator, std::vector<Touch>(static_cast<std::size_t>(num_instances), touchAt(n)), kDt);
  }
  return frame;
}

std::vector<Vector3> forcesOf(const FrameView& frame, int instance, int num_taxels) {
  std::vector<Vector3> forces;
  for (std::size_t t = 0; t < static_cast<std::size_t>(num_taxels); ++t) {
    const std::size_t at = static_cast<std::size_t>(instance * num_taxels) + t;
    const GroundTruthView& truth = frame.ground_truth;
    forces.push_back({truth.tactile_shear_force[2 * at], truth.tactile_shear_force[2 * at + 1], truth.tactile_normal_force[at]});
  }
  return forces;
}

std::vector<std::int32_t> countsOf(const FrameView& frame, int instance, int num_taxels) {
  const auto counts =
      frame.taxel_counts.subspan(static_cast<std::size_t>(3 * instance * num_taxels), static_cast<std::size_t>(3 * num_taxels));
  return {counts.begin(), counts.end()};
}

TEST(ThreeAxisOnDevice, MatchesTheTwin) {
  const Sensor sensor = frictionSensor(kAxes);
  Simulator simulator = support::makeSimulator(sensor, objects(), {.seed = kSeed, .outputs = {.taxel_counts = true}});
  const ReadoutVariation variation{.gain = 1.2f, .gain_spread = 0.3f};
  reference::ThreeAxis twin(sensor, {.seed = kSeed, .episode = kEpisode, .gain = variation.gain, .gain_spread = variation.gain_spread});
  simulator.reset(0, kEpisode, variation);
  int largest_shear = 0, largest_normal = 0;
  for (int n = 0; n < kNumSteps; ++n) {
    const FrameView frame = support::stepOnce(simulator, {touchAt(n)}, kDt);
    const std::vector<std::int32_t> counts = countsOf(frame, 0, numTaxels(sensor));
    const std::vector<std::int32_t> expected = twin.step(forcesOf(frame, 0, numTaxels(sensor)), static_cast<std::uint32_t>(n));
    for (std::size_t k = 0; k < counts.size(); ++k) {
      EXPECT_NEAR(counts[k], expected[k], kOneCount + kRelative * std::abs(expected[k])) << "step " << n << ", value " << k;
      int& largest = k % 3 == 2 ? largest_normal : largest_shear;
      largest = std::max(largest, std::abs(counts[k]));
    }
  }
  EXPECT_GT(largest_shear, 50);
  EXPECT_GT(largest_normal, 100);
}

// Without noise and hysteresis the counts are a linear map of the forces.
TEST(ThreeAxisOnDevice, CrossTalkIsTheMatrixTimesTheForce) {
  ThreeAxisReadout axes = kAxes;
  axes.noise = axes.hysteresis_strength = {0, 0, 0};
  Sensor sensor = frictionSensor(axes);
  sensor.readout.taxel_gain.clear();
  Simulator simulator = support::makeSimulator(sensor, objects(), {.outputs = {.taxel_counts = true}});
  const FrameView frame = follow(simulator, 1, 0, 3);
  const std::vector<Vector3> forces = forcesOf(frame, 0, numTaxels(sensor));
  for (std::size_t t = 0; t < forces.size(); ++t) {
    for (std::size_t a = 0; a < 3; ++a) {
      const double signal = axes.gain[a][0] * forces[t][0] + axes.gain[a][1] * forces[t][1] + axes.gain[a][2] * forces[t][2];
      EXPECT_NEAR(frame.taxel_counts[3 * t + a], signal, 0.5 + kOneCount * 1e-3) << "taxel " << t << ", axis " << a;
    }
  }
}

TEST(ThreeAxisOnDevice, SaturatesOnBothSides) {
  ThreeAxisReadout axes = kAxes;
  axes.gain = {{{1e6, 0, 0}, {0, 1e6, 0}, {0, 0, -1e6}}};
  axes.saturation = 1234;
  Simulator simulator = support::makeSimulator(
      frictionSensor(axes), objects(), {.outputs = {.tactile_normal_force = false, .tactile_shear_force = false, .taxel_counts = true}});
  const FrameView frame = follow(simulator, 1, 0, 3);
  EXPECT_EQ(*std::max_element(frame.taxel_counts.begin(), frame.taxel_counts.end()), 1234);
  EXPECT_EQ(*std::min_element(frame.taxel_counts.begin(), frame.taxel_counts.end()), -1234);
}

// Without contact the counts are the noise: of its level on each axis, rounded, and of no axis the same as of another.
TEST(ThreeAxisOnDevice, NoiseHasItsLevelAndIsIndependent) {
  constexpr int kNumInstances = 100;
  const Sensor sensor = frictionSensor(kAxes);
  Simulator simulator =
      support::makeSimulator(sensor, objects(), {.num_instances = kNumInstances, .seed = kSeed, .outputs = {.taxel_counts = true}});
  for (int i = 0; i < kNumInstances; ++i) simulator.reset(i, static_cast<std::uint64_t>(i));
  const auto counts = support::stepOnce(simulator, kDt).taxel_counts;
  std::array<Vector3, 3> products{};
  for (std::size_t k = 0; k < counts.size(); k += 3) {
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) products[a][b] += static_cast<double>(counts[k + a]) * counts[k + b];
    }
  }
  const double num_draws = static_cast<double>(counts.size()) / 3;
  const double five_deviations = 5 / std::sqrt(num_draws);  // of a correlation; of a variance sqrt(2) as much
  for (std::size_t a = 0; a < 3; ++a) {
    const double variance = kAxes.noise[a] * kAxes.noise[a] + 1.0 / 12;
    EXPECT_NEAR(products[a][a] / num_draws, variance, std::sqrt(2) * five_deviations * variance) << "axis " << a;
    const std::size_t b = (a + 1) % 3;
    EXPECT_NEAR(products[a][b] / std::sqrt(products[a][a] * products[b][b]), 0, five_deviations) << "axes " << a << " and " << b;
  }
}

// At half the rate of the steps every second frame is the one before.
TEST(ThreeAxisOnDevice, CountsStayBetweenTheSensorsFrames) {
  Sensor sensor = frictionSensor(kAxes);
  sensor.frame_rate = 0.5 / kDt;
  Simulator simulator = support::makeSimulator(sensor, objects(), {.seed = kSeed, .outputs = {.taxel_counts = true}});
  std::vector<std::int32_t> last;
  for (int n = 0; n < kNumSteps; ++n) {
    const std::vector<std::int32_t> counts = countsOf(follow(simulator, 1, n, n + 1), 0, numTaxels(sensor));
    EXPECT_EQ(counts == last, n % 2 == 1) << "step " << n;
    last = counts;
  }
}

// The play operators of an instance start anew at its reset, and stay while another instance steps.
TEST(ThreeAxisOnDevice, DoesNotDependOnTheBatch) {
  const Sensor sensor = frictionSensor(kAxes);
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects()});
  constexpr int kNumInstances = 3;
  Simulator batch(model, {.num_instances = kNumInstances, .seed = kSeed, .outputs = {.taxel_counts = true}});
  Simulator alone(model, {.seed = kSeed, .outputs = {.taxel_counts = true}});
  FrameView frame;
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < kNumInstances; ++i) batch.reset(i, kEpisode);
    follow(batch, kNumInstances, 0, 3);
    batch.reset(0, kEpisode);
    batch.step(kDt, std::vector<std::uint8_t>{1, 0, 0});
    batch.read();
    frame = follow(batch, kNumInstances, 3, kNumSteps);
  }
  alone.reset(0, kEpisode);
  const std::vector<std::int32_t> expected = countsOf(follow(alone, 1, 0, kNumSteps), 0, numTaxels(sensor));
  for (int i = 1; i < kNumInstances; ++i) EXPECT_EQ(countsOf(frame, i, numTaxels(sensor)), expected) << "instance " << i;
}

TEST(ThreeAxisOnDevice, IsRefusedWithoutTheElectronics) {
  Sensor sensor = frictionSensor(kAxes);
  sensor.readout.three_axis.reset();
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects()});
  EXPECT_EQ(support::inputError([&] { Simulator(model, {.outputs = {.taxel_counts = true}}); }),
            "outputs.taxel_counts: true is not allowed for a sensor without readout.three_axis");
  const Model with(support::sharedDevice(), {.sensor = frictionSensor(kAxes), .objects = objects()});
  EXPECT_EQ(
      support::inputError([&] { Simulator(with, {.outputs = {.penetration_depth = false, .taxel_counts = true}, .max_contacts = 1}); }),
      "outputs.taxel_counts: true is not allowed where max_contacts > 0: contacts have no shear");
}

}  // namespace
}  // namespace taxelsim
