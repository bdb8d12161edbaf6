// Simulator::vjp(): against differences of forces of moved sensors, against the contraction of the taxels' Jacobian in double precision, in
// batches, and what it refuses.
#include "reference/tactile_jacobian.h"
#include "simulation/comparison.h"
#include "simulation/layer_scene.h"
#include "support/cases.h"
#include "support/curved_sensor.h"
#include "support/input_error.h"
#include "support/jacobian_cases.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Random;
using support::Touch;

constexpr double kDt = 0.01;          // s
constexpr double kRadius = 8e-3;      // m, of the ball
constexpr std::size_t kNumTwist = 6;  // coordinates
constexpr OutputOptions kOutputs{.taxel_jacobian = true, .vjp = true};

// ---- sensors ----

Psf unevenPsf(Random& random, int size) {
  Psf psf{.size = size, .kernel = {}};
  for (int n = 0; n < size * size; ++n) psf.kernel.push_back(random.uniform(0, 1));
  return psf;
}

Sensor areaSensor(Sensor sensor) {
  sensor.depth_sampling = DepthSampling::kArea;
  return sensor;
}

Sensor gridWithKernel() {
  Random random(2);
  Sensor sensor = areaSensor(support::gridSensor({.num_rows = 7, .num_cols = 9}));
  sensor.psf = unevenPsf(random, 3);
  return sensor;
}

Sensor gridWithMask() {
  Random random(3);
  Sensor sensor = areaSensor(support::gridSensor({.num_rows = 8, .num_cols = 7}));
  sensor.skin.law = DeformationMask{};
  sensor.psf = unevenPsf(random, 5);
  return sensor;
}

// Patches have lists of sources, of which those of an uneven kernel are not those of receivers.
Sensor twoPatches() {
  Random random(5);
  Sensor sensor = areaSensor(support::gridSensor({.num_rows = 5, .num_cols = 6}));
  support::addPatch(sensor, {{0.03, 0, 0}, axisAngle({0, 1, 0}, 0.2)});
  sensor.psf = unevenPsf(random, 3);
  return sensor;
}

Sensor curvedList() {
  Sensor sensor = areaSensor(support::cylinderFingertip(9e-3, 1.2, 9, 7, 2.4e-3));
  sensor.psf.sigma = 1.5e-3;
  return sensor;
}

// ---- losses ----

struct Loss {
  std::vector<float> cotangent, gain;  // (num_instances x num_taxels)

  double weight(std::size_t i) const { return static_cast<double>(cotangent[i]) * static_cast<double>(gain.empty() ? 1.0f : gain[i]); }
};

// The same for `repeat` instances in sequence.
Loss randomLoss(Random& random, std::size_t num_contacts, std::size_t repeat, std::size_t num_taxels) {
  Loss loss;
  for (std::size_t contact = 0; contact < num_contacts; ++contact) {
    Loss row;
    for (std::size_t t = 0; t < num_taxels; ++t) {
      row.cotangent.push_back(static_cast<float>(random.uniform(-1, 1)));
      row.gain.push_back(static_cast<float>(random.uniform(0.5, 1.5)));
    }
    for (std::size_t n = 0; n < repeat; ++n) {
      loss.cotangent.insert(loss.cotangent.end(), row.cotangent.begin(), row.cotangent.end());
      loss.gain.insert(loss.gain.end(), row.gain.begin(), row.gain.end());
    }
  }
  return loss;
}

using Twist = std::array<double, kNumTwist>;

// Sum of magnitudes of the terms, for bounds of rounding: the contact forces' derivatives of the twin, spread as the forces are. A kernel
// that is normalised gives a taxel at most the largest weight of the loss.
Twist grossOf(const Sensor& sensor, std::span<const reference::PlacedObject> objects, double largest_weight) {
  const reference::Frame frame = reference::simulateFrame(sensor, {.objects = {objects.begin(), objects.end()}});
  Twist gross{};
  for (const reference::ByTwist& taxel : reference::tactileJacobian(sensor, frame).taxel_force) {
    for (std::size_t k = 0; k < kNumTwist; ++k) gross[k] += largest_weight * std::abs(taxel[k]);
  }
  // A mask sums to 1 after its rescaling, whose own derivative adds no more than as much again.
  if (std::holds_alternative<DeformationMask>(sensor.skin.law)) {
    for (double& size : gross) size *= 2;
  }
  return gross;
}

// Roundings of a term: of a spread over at most `num_taxels` taxels in both contractions, of its products, and of sums by lanes, of which
// there are 8 to 64 for 16 taxels each.
double numRoundings(std::size_t num_taxels) {
  const auto taxels = static_cast<double>(num_taxels);
  return 2 * (taxels + 1) + 3 + taxels / 8 + 64;
}

// The gradient of an instance against its closed form: the contraction of the frame's own arrays.
void expectContraction(const FrameView& frame, const GradientView& gradient, const Loss& loss, std::size_t instance, std::size_t num_taxels,
                       const Twist& gross) {
  const std::size_t first = instance * num_taxels;
  for (std::size_t k = 0; k < kNumTwist; ++k) {
    double sum = 0;
    for (std::size_t t = 0; t < num_taxels; ++t) {
      sum += loss.weight(first + t) * static_cast<double>(frame.ground_truth.taxel_jacobian[kNumTwist * first + k * num_taxels + t]);
    }
    EXPECT_NEAR(gradient.twist[kNumTwist * instance + k], sum, numRoundings(num_taxels) * support::kUlp * gross[k]) << "coordinate " << k;
  }
  for (std::size_t i = first; i < first + num_taxels; ++i) {
    EXPECT_FLOAT_EQ(gradient.gain[i], loss.cotangent[i] * frame.ground_truth.tactile_normal_force[i]);
  }
}

// ---- against differences ----

// Where the outline of a contact crosses a side of a taxel, the mean of the cells on both sides, of width h, is off by up to the slope of
// the depth x h / 4: 0.35 x 0.85 mm / 4 over two cells of a crossing, 0.13 mm^2 x the stiffness. Some ten crossings with random signs are
// 0.4 mm^2; the derivatives of the forces by pressing sum to the contact's area, 20 mm^2: 0.02. At a side without a neighbour, as all are
// in a list, the pressure is extrapolated over half a cell, with as much error again.
constexpr double kCrossings = 0.04;

constexpr std::size_t kContacts = 4;
constexpr std::size_t kPoses = 1 + 2 * kNumTwist;  // of a contact: its own, then both sides of every coordinate
constexpr double kStep = 4e-6, kTurn = 4e-4;       // m, rad
double stepOf(std::size_t k) {
  return k < 3 ? kStep : kTurn;
}

// Balls that press 0.3 to 0.6 mm deep on a grid, or on a random taxel of a list.
std::vector<Touch> movedTouches(Random& random, const Sensor& sensor) {
  std::vector<Touch> touches;
  for (std::size_t contact = 0; contact < kContacts; ++contact) {
    const bool is_list = sensor.patches.size() > 1;
    const double reach = is_list ? 1e-3 : 6e-3, depth = random.uniform(0.3e-3, 0.6e-3);
    const Pose X_PO{{random.uniform(-reach, reach), random.uniform(-reach, reach), kRadius - depth}};
    const auto patch = static_cast<std::size_t>(random.integer(0, static_cast<int>(sensor.patches.size()) - 1));
    const Pose X_SO = sensor.patches[patch].X_SP * X_PO;
    touches.push_back({{0}, {X_SO}});
    for (std::size_t k = 0; k < kNumTwist; ++k) {
      for (const double sign : {-1, 1}) touches.push_back({{0}, {support::afterTwist(X_SO, k, sign * stepOf(k))}});
    }
  }
  return touches;
}

// Largest error of a contact, relative to the sum of the magnitudes of all taxels' terms, of the largest by velocity and by rotation:
// random cotangents may cancel.
double errorOf(const FrameView& frame, const GradientView& gradient, const Loss& loss, std::size_t contact, std::size_t num_taxels) {
  const std::size_t at = contact * kPoses;
  std::array<double, 2> largest{}, error{};
  for (std::size_t k = 0; k < kNumTwist; ++k) {
    const auto low = frame.ground_truth.tactile_normal_force.subspan((at + 1 + 2 * k) * num_taxels, num_taxels);
    const auto high = frame.ground_truth.tactile_normal_force.subspan((at + 2 + 2 * k) * num_taxels, num_taxels);
    double expected = 0, gross = 0;
    for (std::size_t t = 0; t < num_taxels; ++t) {
      const double term = loss.weight(at * num_taxels + t) * (static_cast<double>(high[t]) - static_cast<double>(low[t])) / (2 * stepOf(k));
      expected += term;
      gross += std::abs(term);
    }
    largest[k / 3] = std::max(largest[k / 3], gross);
    error[k / 3] = std::max(error[k / 3], std::abs(static_cast<double>(gradient.twist[kNumTwist * at + k]) - expected));
  }
  return std::max(error[0] / largest[0], error[1] / largest[1]);
}

void press(Simulator& simulator, const std::vector<Touch>& touches) {
  support::setTouches(simulator, touches);
  simulator.step(kDt);
}

void expectGradients(const Sensor& sensor) {
  Random random(8);
  const std::vector<Object> objects{Object(Sphere{kRadius})};
  const std::vector<Touch> touches = movedTouches(random, sensor);
  Simulator simulator(Model(support::sharedDevice(), {.sensor = sensor, .objects = objects}),
                      {.num_instances = static_cast<int>(touches.size()), .outputs = kOutputs});
  press(simulator, touches);
  const FrameView frame = simulator.read();
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  Loss loss = randomLoss(random, kContacts, kPoses, num_taxels);
  for (const bool with_gains : {true, false}) {
    SCOPED_TRACE(with_gains ? "with gains" : "without gains");
    if (!with_gains) loss.gain.clear();
    const GradientView gradient = simulator.vjp(loss.cotangent, loss.gain);
    double worst = 0;
    for (std::size_t contact = 0; contact < kContacts; ++contact) {
      const std::size_t at = contact * kPoses;
      const Twist gross = grossOf(sensor, touches[at].placed(objects), with_gains ? 1.5 : 1);
      expectContraction(frame, gradient, loss, at, num_taxels, gross);
      worst = std::max(worst, errorOf(frame, gradient, loss, contact, num_taxels));
    }
    EXPECT_LT(worst, kCrossings);
    std::printf("largest error against differences: %.4f\n", worst);
  }
}

TEST(ForceGradientOnEveryDriver, OfAGridIsThatOfDifferences) {
  expectGradients(gridWithKernel());
}
TEST(ForceGradientOnEveryDriver, OfADeformationMaskIsThatOfDifferences) {
  expectGradients(gridWithMask());
}
TEST(ForceGradientOnEveryDriver, OfTwoPatchesIsThatOfDifferences) {
  expectGradients(twoPatches());
}
TEST(ForceGradientOnEveryDriver, OfACurvedListIsThatOfDifferences) {
  expectGradients(curvedList());
}

// The layer's own Jacobian is compared with differences elsewhere.
TEST(ForceGradientOnEveryDriver, OfAnElasticLayerIsTheContraction) {
  Random random(4);
  const Sensor sensor = support::layerSensor({}, {.num_rows = 4, .num_cols = 5, .samples_per_taxel = 2});
  Simulator simulator(Model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{kRadius})}}),
                      {.num_instances = 2, .outputs = kOutputs});
  press(simulator, {{{0}, {{.position = {1e-3, 0, kRadius - 0.5e-3}}}}, {{0}, {{.position = {-2e-3, 1e-3, kRadius - 0.3e-3}}}}});
  const FrameView frame = simulator.read();
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  const Loss loss = randomLoss(random, 2, 1, num_taxels);
  const GradientView gradient = simulator.vjp(loss.cotangent, loss.gain);
  for (std::size_t i = 0; i < 2; ++i) {
    // Without a spread, these are the terms.
    Twist gross{};
    for (std::size_t n = 0; n < kNumTwist * num_taxels; ++n) {
      const double term = static_cast<double>(frame.ground_truth.taxel_jacobian[i * kNumTwist * num_taxels + n]);
      gross[n / num_taxels] += std::abs(loss.weight(i * num_taxels + n % num_taxels) * term);
    }
    EXPECT_GT(gross[2], 0);
    expectContraction(frame, gradient, loss, i, num_taxels, gross);
  }
}

// ---- batches ----

std::vector<std::uint32_t> bitsOf(std::span<const float> values) {
  std::vector<std::uint32_t> bits;
  for (const float value : values) bits.push_back(std::bit_cast<std::uint32_t>(value));
  return bits;
}

// Bits of each instance's gradient.
std::vector<std::vector<std::uint32_t>> gradientBits(const Model& model, std::span<const Touch> touches, const Loss& loss) {
  Simulator simulator(model, {.num_instances = static_cast<int>(touches.size()), .outputs = {.vjp = true}});
  press(simulator, {touches.begin(), touches.end()});
  simulator.read();
  const auto num_taxels = static_cast<std::size_t>(numTaxels(model.sensor()));
  const std::size_t num_values = touches.size() * num_taxels;
  const GradientView gradient = simulator.vjp(std::span(loss.cotangent).first(num_values), std::span(loss.gain).first(num_values));
  std::vector<std::vector<std::uint32_t>> bits;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    bits.push_back(bitsOf(gradient.twist.subspan(kNumTwist * i, kNumTwist)));
    const std::vector<std::uint32_t> by_gain = bitsOf(gradient.gain.subspan(num_taxels * i, num_taxels));
    bits.back().insert(bits.back().end(), by_gain.begin(), by_gain.end());
  }
  return bits;
}

// One invocation per instance, or teams of four and of eight, the last of them without an instance.
TEST(ForceGradientOnEveryDriver, IndependentOfBatchAndWorkgroup) {
  constexpr std::size_t kBatch = 64;
  Random random(6);
  const Sensor sensor = gridWithKernel();
  const Object ball(Sphere{kRadius});
  std::vector<Touch> touches;
  while (touches.size() < kBatch) touches.push_back({{0}, {support::randomContact(random, sensor, ball)}});
  const Loss loss = randomLoss(random, kBatch, 1, static_cast<std::size_t>(numTaxels(sensor)));
  std::vector<std::vector<std::uint32_t>> expected;
  for (const int workgroup : {0, 4, 64}) {
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {ball}, .image_workgroup = workgroup});
    for (const std::size_t size : {kBatch, std::size_t{7}, std::size_t{1}}) {
      SCOPED_TRACE("workgroup " + std::to_string(workgroup) + ", batch " + std::to_string(size));
      const auto found = gradientBits(model, std::span(touches).first(size), loss);
      if (expected.empty()) expected = found;
      for (std::size_t i = 0; i < size; ++i) EXPECT_EQ(found[i], expected[i]) << i;
    }
  }
}

TEST(ForceGradientOnDevice, LargestArray) {
  const Sensor sensor = support::gridSensor({.num_rows = 128, .num_cols = 128, .pitch_x = 1e-3, .pitch_y = 1e-3, .samples_per_taxel = 2});
  Simulator simulator(Model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.3})}}), {.outputs = kOutputs});
  press(simulator, {{{0}, {{{3e-3, -2e-3, 0.2994}}}}});
  const FrameView frame = simulator.read();
  const std::vector<float> ones(static_cast<std::size_t>(numTaxels(sensor)), 1);
  const GradientView gradient = simulator.vjp(ones);
  double by_press = 0;
  for (const float change : frame.ground_truth.taxel_jacobian.subspan(2 * ones.size(), ones.size()))
    by_press += static_cast<double>(change);
  EXPECT_GT(by_press, 0);
  EXPECT_NEAR(gradient.twist[2], by_press, numRoundings(ones.size()) * support::kUlp * std::abs(by_press));
}

// ---- what a call leaves alone ----

TEST(ForceGradientOnDevice, ChangesNoFrame) {
  Sensor sensor = gridWithKernel();
  sensor.readout = support::paperReadout();
  sensor.readout.noise = 5;
  sensor.readout.low_pass_time = 0.02;
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{kRadius})}});
  const SimulatorOptions options{.num_instances = 2, .outputs = {.vjp = true}};
  Simulator plain(model, options), asked(model, options);
  const std::vector<float> ones(2 * static_cast<std::size_t>(numTaxels(sensor)), 1);
  std::vector<float> twist;
  for (const double depth : {0.3e-3, 0.5e-3, 0.4e-3}) {
    const std::vector<Touch> touches(2, Touch{{0}, {{.position = {0, 0, kRadius - depth}}}});
    press(plain, touches);
    press(asked, touches);
    const FrameView expected = plain.read(), found = asked.read();
    const GradientView first = asked.vjp(ones);
    twist.assign(first.twist.begin(), first.twist.end());
    EXPECT_EQ(bitsOf(asked.vjp(ones).twist), bitsOf(twist));
    EXPECT_GT(twist[2], 0);
    for (int i = 0; i < 2; ++i) EXPECT_EQ(support::bitsOf(found, i, 2), support::bitsOf(expected, i, 2)) << i;
  }
  // An instance that a step holds keeps its gradient; one that lost contact has none.
  asked.reset(1, 0);
  support::setTouches(asked, std::vector<Touch>(2, Touch{{0}, {{.position = {0, 0, 1}}}}));
  asked.step(kDt, std::vector<std::uint8_t>{0, 1});
  asked.read();
  const GradientView held = asked.vjp(ones);
  EXPECT_EQ(bitsOf(held.twist.first(kNumTwist)), bitsOf(std::span(twist).first(kNumTwist)));
  for (const float value : held.twist.subspan(kNumTwist)) EXPECT_EQ(value, 0);
}

// ---- errors ----

TEST(ForceGradientErrors, RejectsInvalidInput) {
  Simulator simulator =
      support::makeSimulator(support::gridSensor(), {Object(Sphere{kRadius})}, {.num_instances = 2, .outputs = {.vjp = true}});
  const std::vector<float> ones(2 * 84, 1);
  const std::vector<Touch> touches(2, Touch{{0}, {{.position = {0, 0, kRadius - 0.5e-3}}}});
  EXPECT_THROW(simulator.vjp(ones), std::logic_error);
  press(simulator, touches);
  EXPECT_THROW(simulator.vjp(ones), std::logic_error);
  simulator.read();
  const std::vector<std::uint32_t> before = bitsOf(simulator.vjp(ones).twist);

  const auto refusal = [&](std::span<const float> cotangent, std::span<const float> gain = {}) {
    return support::inputError([&] { simulator.vjp(cotangent, gain); });
  };
  EXPECT_EQ(refusal(std::span(ones).first(84)), "cotangent: 84 values are not allowed: 168");
  EXPECT_EQ(refusal({}), "cotangent: 0 values are not allowed: 168");
  EXPECT_EQ(refusal(ones, std::span(ones).first(1)), "gain: 1 values are not allowed: 168");
  std::vector<float> bad = ones;
  bad[84 + 5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(refusal(bad), "cotangent of instance 1, taxel 5: nan is not allowed: finite numbers");
  EXPECT_EQ(refusal(ones, bad), "gain of instance 1, taxel 5: nan is not allowed: finite numbers");
  bad[84 + 5] = 1e30f;
  EXPECT_EQ(refusal(bad, bad), "cotangent x gain of instance 1, taxel 5: inf is not allowed: finite numbers");
  EXPECT_EQ(bitsOf(simulator.vjp(ones).twist), before);
}

TEST(ForceGradientErrors, NeedsItsOption) {
  const Model model(support::sharedDevice(), {.sensor = support::gridSensor(), .objects = {Object(Sphere{kRadius})}});
  Simulator simulator(model, {.outputs = {.taxel_jacobian = true}});
  EXPECT_EQ(support::inputError([&] { simulator.vjp(std::vector<float>(84, 1)); }), "vjp() needs a simulator with outputs.vjp: true");
  const std::string refusal =
      support::inputError([&] { Simulator(model, {.outputs = {.penetration_depth = false, .vjp = true}, .max_contacts = 4}); });
  EXPECT_EQ(refusal.find("outputs.vjp: true is not allowed where max_contacts > 0"), 0u) << refusal;
  const MemoryPlan with = Simulator::plan(model, {.outputs = {.vjp = true}}), without = Simulator::plan(model, {});
  EXPECT_GT(with.bytes_per_instance, without.bytes_per_instance);
}

}  // namespace
}  // namespace taxelsim
