// Counts converted to newtons: closed forms, and round trips through the reference's stages.
#include "taxelsim/readings.h"

#include "reference/lag.h"
#include "reference/psf.h"
#include "reference/readout.h"
#include "sensor/example_sensor.h"
#include "support/curved_sensor.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kCountsPerNewton = 20000;
constexpr double kHalfCount = 0.5 / kCountsPerNewton;  // N: error of rounding to counts
constexpr double kFloat32 = 1e-6;                      // relative, for counts that are not rounded

Sensor linearSensor() {
  Sensor sensor = exampleSensor();
  sensor.psf = {};
  sensor.readout = {.curve = {kCountsPerNewton}, .adc_bits = 16, .saturation = 65535, .taxel_gain = {}, .taxel_trigger = {}};
  return sensor;
}

Sensor strip(int num_taxels) {
  Sensor sensor = linearSensor();
  sensor.patches[0].num_rows = 1;
  sensor.patches[0].num_cols = num_taxels;
  return sensor;
}

// 1000 x + 200 x^2 at x = 0.5 is 550; of taxel 1, with gain 2 and trigger 0.1, that is (0.5 + 0.1) / 2 N.
TEST(Readings, ByHand) {
  Sensor sensor = strip(4);
  sensor.readout.curve = {1000, 200};
  sensor.readout.output_scale = 2;
  sensor.readout.trigger = 0.05;
  sensor.readout.taxel_gain = {1, 2, 0, 1};
  sensor.readout.taxel_trigger = {0.05, 0.1, 0, 0};
  sensor.readout.saturation = 1100;
  const Readings readings = readingsInNewtons(sensor, {.num_taxels = 4, .time = {}, .counts = {1100, 1100, 1100, 0, 0, 0, 0, 1200}});
  const std::vector<double> expected{0.55, 0.3, 0, 0, 0, 0, 0, 0.5};
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(readings.force[k], expected[k], 1e-12) << k;
  EXPECT_EQ(readings.dead_taxels, std::vector<int>{2});
  EXPECT_EQ(readings.num_saturated, 4u);
}

TEST(Readings, UndoTheReadout) {
  Sensor sensor = linearSensor();
  sensor.readout.curve = {kCountsPerNewton, 3000, 500};  // steeper than kCountsPerNewton everywhere
  std::mt19937 random(1);
  std::uniform_real_distribution<double> draw(0, 1);
  std::vector<double> force;
  for (int t = 0; t < numTaxels(sensor); ++t) {
    sensor.readout.taxel_gain.push_back(0.5 + draw(random));
    sensor.readout.taxel_trigger.push_back(0.1 * draw(random));
    force.push_back(0.4 + draw(random));  // above every trigger
  }
  const std::vector<std::uint32_t> counts = reference::readOut(sensor, force);
  const Readings readings = readingsInNewtons(sensor, {.num_taxels = counts.size(), .time = {}, .counts = {counts.begin(), counts.end()}});
  EXPECT_EQ(readings.num_saturated, 0u);
  for (std::size_t t = 0; t < force.size(); ++t) {
    EXPECT_NEAR(readings.force[t], force[t], (1 + 1e-9) * kHalfCount / sensor.readout.taxel_gain[t]) << t;
  }
}

// A constant force from the first row on reads F [1 + sum fraction (1 - e^(-t / time))], for any sampling times.
TEST(Readings, CreepOfAStep) {
  Sensor sensor = strip(1);
  sensor.readout.creep = {{.fraction = 0.15, .time = 1}, {.fraction = 0.3, .time = 9}};
  constexpr double kForce = 0.8;
  Images images{.num_taxels = 1, .time = {}, .counts = {}};
  for (const double t : {0.0, 0.03, 0.06, 0.5, 0.51, 4.0, 4.1, 30.0, 200.0}) {
    const double grown = 1 + 0.15 * (1 - std::exp(-t)) + 0.3 * (1 - std::exp(-t / 9));
    images.time.push_back(3 + t);
    images.counts.push_back(static_cast<float>(kCountsPerNewton * kForce * grown));
  }
  const Readings removed = readingsInNewtons(sensor, images, {.remove_creep = true});
  for (const double force : removed.force) EXPECT_NEAR(force, kForce, kFloat32);
  const Readings left = readingsInNewtons(sensor, images);
  EXPECT_NEAR(left.force.back(), 1.45 * kForce, kFloat32);
}

// The impulse response of the inverse has one positive value of at most 1, then negative ones with a smaller sum: rounding errors at most
// double.
constexpr double kInverseOfCreep = 2;

Images recorded(const Sensor& sensor, const std::vector<std::vector<double>>& forces, const std::vector<double>& time) {
  reference::Lag lag(sensor.readout, static_cast<std::size_t>(numTaxels(sensor)));
  Images images{.num_taxels = static_cast<std::size_t>(numTaxels(sensor)), .time = time, .counts = {}};
  for (std::size_t row = 0; row < forces.size(); ++row) {
    const double dt = row == 0 ? 1 : time[row] - time[row - 1];
    for (const std::uint32_t counts : reference::readOut(sensor, lag.step(reference::spread(sensor, forces[row]), dt))) {
      images.counts.push_back(static_cast<float>(counts));
    }
  }
  return images;
}

// Changing presses on a few taxels, none at first, with uneven sampling.
struct Presses {
  std::vector<double> time;
  std::vector<std::vector<double>> force;  // (rows), (num_taxels)

  Presses(std::size_t num_taxels, unsigned seed) : time{0}, force{std::vector<double>(num_taxels, 0.0)} {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(0, 1);
    for (int row = 1; row < 60; ++row) {
      time.push_back(time.back() + 0.01 + 0.5 * draw(random));
      force.push_back(force.back());
      for (double& value : force.back()) {
        if (draw(random) < 0.1) value = draw(random) < 0.6 ? 0 : draw(random);
      }
    }
  }
};

TEST(Readings, UndoCreep) {
  Sensor sensor = linearSensor();
  sensor.readout.creep = {{.fraction = 0.15, .time = 1}, {.fraction = 0.3, .time = 9}};
  const Presses presses(84, 2);
  const Readings readings = readingsInNewtons(sensor, recorded(sensor, presses.force, presses.time), {.remove_creep = true});
  for (std::size_t k = 0; k < readings.force.size(); ++k) {
    EXPECT_NEAR(readings.force[k], presses.force[k / 84][k % 84], (1 + 1e-9) * kInverseOfCreep * kHalfCount) << k;
  }
}

// After a long press the remaining creep of 0.3 N is below the trigger: the result is no force, and no negative force.
TEST(Readings, CreepUnderTheTrigger) {
  Sensor sensor = strip(1);
  sensor.readout.creep = {{.fraction = 0.3, .time = 9}};
  sensor.readout.trigger = 0.35;
  const Images images{.num_taxels = 1,
                      .time = {0, 1000, 1000.01, 1000.02},
                      .counts = {static_cast<float>(kCountsPerNewton * 0.65), static_cast<float>(kCountsPerNewton * 0.95), 0, 0}};
  const std::vector<double> force = readingsInNewtons(sensor, images, {.remove_creep = true}).force;
  EXPECT_NEAR(force[1], 1, kFloat32);
  EXPECT_EQ(force[2], 0);
  EXPECT_EQ(force[3], 0);
}

// The sampled kernel of sigma 0.5, normalised, is the product of (0.1065, 0.787, 0.1065) with itself; on an infinite grid its
// smallest gain is 0.787 - 2 x 0.1065 = 0.574 per direction. Borders only restrict that grid and normalise by less.
constexpr double kLeastSpread = 0.574 * 0.574;

double distanceOf(const std::vector<double>& a, const std::vector<double>& b) {
  double squares = 0;
  for (std::size_t t = 0; t < a.size(); ++t) squares += (a[t] - b[t]) * (a[t] - b[t]);
  return std::sqrt(squares);
}

TEST(Readings, UndoSpreadAndCreepAndReadout) {
  Sensor sensor = linearSensor();
  sensor.psf = gaussianPsf(0.5, 3);
  for (const bool creeps : {false, true}) {
    if (creeps) sensor.readout.creep = {{.fraction = 0.15, .time = 1}, {.fraction = 0.3, .time = 9}};
    const Presses presses(84, 3);
    const Readings readings =
        readingsInNewtons(sensor, recorded(sensor, presses.force, presses.time), {.remove_creep = true, .remove_spread = true});
    const double per_taxel = (creeps ? kInverseOfCreep : 1) * kHalfCount;
    for (std::size_t row = 0; row < presses.force.size(); ++row) {
      const auto first = readings.force.begin() + static_cast<std::ptrdiff_t>(84 * row);
      EXPECT_LT(distanceOf({first, first + 84}, presses.force[row]), std::sqrt(84) * per_taxel / kLeastSpread) << row;
    }
  }
}

// Images outside the range of G: by the optimality conditions, the gradient of ||G F - image||^2 is 0 for F > 0 and >= 0 for F = 0.
void expectNearest(const Sensor& sensor, unsigned seed) {
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> draw(0, 60000);
  for (int repeat = 0; repeat < 5; ++repeat) {
    Images images{.num_taxels = num_taxels, .time = {}, .counts = {}};
    std::vector<double> image;
    for (std::size_t t = 0; t < num_taxels; ++t) {
      const int counts = std::max(0, draw(random) - 30000);
      images.counts.push_back(static_cast<float>(counts));
      image.push_back(counts / kCountsPerNewton);
    }
    const std::vector<double> force = readingsInNewtons(sensor, images, {.remove_spread = true}).force;
    const std::vector<double> spread = reference::spread(sensor, force);
    int num_at_zero = 0;
    for (std::size_t source = 0; source < num_taxels; ++source) {
      std::vector<double> one(num_taxels, 0.0);
      one[source] = 1;
      const std::vector<double> column = reference::spread(sensor, one);
      double slope = 0;
      for (std::size_t t = 0; t < num_taxels; ++t) slope += column[t] * (spread[t] - image[t]);
      constexpr double kSolved = 1e-9;  // N: forces of order 1 N and a matrix of condition 1e3 at most, in double
      EXPECT_GE(force[source], 0);
      EXPECT_GE(slope, -kSolved) << source;
      if (force[source] > 0) {
        EXPECT_NEAR(slope, 0, kSolved) << source;
      }
      num_at_zero += force[source] == 0 ? 1 : 0;
    }
    EXPECT_GT(num_at_zero, 0) << "a case without active bounds tests nothing";
  }
}

TEST(Readings, ForcesAreNonNegativeLeastSquares) {
  Sensor sensor = linearSensor();
  sensor.psf = gaussianPsf(0.5, 3);
  expectNearest(sensor, 4);
  sensor.psf = gaussianPsf(0.65, 5, Psf::Normalization::kNone);
  expectNearest(sensor, 5);
}

TEST(Readings, AlongACurvedSkin) {
  Sensor sensor = support::cylinderFingertip(8e-3, 1.2, 7, 5, 2e-3);
  sensor.readout = linearSensor().readout;
  sensor.psf = {.sigma = 1e-3, .reach = 3e-3};
  expectNearest(sensor, 6);
}

TEST(Readings, RejectsSingularSpread) {
  Sensor sensor = strip(2);
  const Images images{.num_taxels = 2, .time = {}, .counts = {10, 20}};
  EXPECT_THROW(readingsInNewtons(strip(3), images), Error);
  EXPECT_THROW(readingsInNewtons(sensor, images, {.remove_creep = true}), Error);
  EXPECT_NO_THROW(readingsInNewtons(sensor, images, {.remove_spread = true}));
  // Singular kernels: three in a row give 0 for (1, -1, 0, 1, -1); two taxels give 0 for (1, -1).
  for (const int num_taxels : {2, 5}) {
    Sensor even = strip(num_taxels);
    even.psf = {.size = 3, .kernel = std::vector<double>(9, 0.3), .normalization = Psf::Normalization::kNone};
    const std::vector<float> counts(static_cast<std::size_t>(num_taxels), 10);
    const Images some{.num_taxels = counts.size(), .time = {}, .counts = counts};
    EXPECT_THROW(readingsInNewtons(even, some, {.remove_spread = true}), Error) << num_taxels;
  }
}

}  // namespace
}  // namespace taxelsim
