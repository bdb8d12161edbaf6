// Stage 4 of the reference against closed forms.
#include "reference/lag.h"

#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::Lag;

// Some thousand roundings of numbers of order 1.
constexpr double kRounding = 1e-12;

// Output of one taxel for a sequence of forces, one per step of dt (s).
std::vector<double> outputs(Lag& lag, const std::vector<double>& path, double dt) {
  std::vector<double> result;
  for (const double force : path) result.push_back(lag.step(std::vector<double>{force}, dt)[0]);
  return result;
}

// num_steps equal increments from `from` (exclusive) to `to`.
std::vector<double> ramp(double from, double to, int num_steps) {
  std::vector<double> path;
  for (int n = 1; n <= num_steps; ++n) path.push_back(from + (to - from) * n / num_steps);
  return path;
}

// Area enclosed by the output over the input, by the trapezoidal rule: exact for piecewise linear loops with breaks at steps.
double loopArea(const std::vector<double>& input, const std::vector<double>& output) {
  double area = 0;
  for (std::size_t n = 1; n < input.size(); ++n) area -= (input[n] - input[n - 1]) * (output[n] + output[n - 1]) / 2;
  return area;
}

Readout hysteresisOf(double strength, double width) {
  Readout readout;
  readout.hysteresis_strength = {strength};
  readout.hysteresis_width = {width};
  return readout;
}

TEST(Lag, WithoutDynamicsReturnsTheInput) {
  Lag lag(Readout{}, 2);
  EXPECT_EQ(lag.step(std::vector<double>{1.25, 3}, 0.1), (std::vector<double>{1.25, 3}));
}

TEST(Lag, CreepAtConstantForceIsExactForAnyStep) {
  Readout readout;
  readout.creep = {{0.1, 0.5}, {0.2, 9}};
  for (const double dt : {1e-3, 0.05, 3.0}) {
    Lag lag(readout, 1);
    const std::vector<double> force = outputs(lag, std::vector<double>(200, 2.0), dt);
    for (std::size_t n = 0; n < force.size(); ++n) {
      const double t = dt * static_cast<double>(n + 1);
      EXPECT_NEAR(force[n], 2 * (1 + 0.1 * (1 - std::exp(-t / 0.5)) + 0.2 * (1 - std::exp(-t / 9))), kRounding);
    }
  }
}

TEST(Lag, LowPassStepResponseIsExponential) {
  Readout readout;
  readout.low_pass_time = 0.3;
  Lag lag(readout, 1);
  const std::vector<double> up = outputs(lag, std::vector<double>(50, 1.0), 0.01), down = outputs(lag, std::vector<double>(50, 0.0), 0.01);
  for (int n = 0; n < 50; ++n) {
    const double left = std::exp(-0.01 * (n + 1) / 0.3);
    EXPECT_NEAR(up[n], 1 - left, kRounding);
    EXPECT_NEAR(down[n], up.back() * left, kRounding);
  }
}

// A play operator of width r and strength w encloses 4 w r (A - r) at amplitude A: branches 2 w r apart over 2 A, less the two slanted
// ends.
TEST(Lag, HysteresisLoopHasClosedFormArea) {
  for (const double width : {0.05, 0.2, 0.4}) {
    const double strength = 0.3, amplitude = 0.5;
    Lag lag(hysteresisOf(strength, width), 1);
    outputs(lag, ramp(0, 2 * amplitude, 100), 0.01);
    std::vector<double> input = ramp(2 * amplitude, 0, 100);
    const std::vector<double> up = ramp(0, 2 * amplitude, 100);
    input.insert(input.end(), up.begin(), up.end());
    input.insert(input.begin(), 2 * amplitude);
    const std::vector<double> output = outputs(lag, input, 0.01);
    EXPECT_NEAR(loopArea(input, output), 4 * strength * width * (amplitude - width), kRounding);
    if (2 * width > amplitude) continue;  // the slanted ends meet before the middle
    EXPECT_NEAR(output[50] - output[150], 2 * strength * width, kRounding) << "gap between the branches";
  }
}

// Return-point memory (wiping-out property of Preisach operators): a closed minor loop leaves no trace.
TEST(Lag, HysteresisHasReturnPointMemory) {
  Readout readout;
  readout.hysteresis_strength = {0.2, 0.1, 0.3};
  readout.hysteresis_width = {0.05, 0.15, 0.4};
  Lag plain(readout, 1), with_loop(readout, 1);
  for (Lag* lag : {&plain, &with_loop}) outputs(*lag, ramp(0, 2, 40), 0.01);
  const double before = outputs(with_loop, {2.0}, 0.01)[0];
  outputs(with_loop, ramp(2, 1.3, 30), 0.01);
  EXPECT_NEAR(outputs(with_loop, ramp(1.3, 2, 30), 0.01).back(), before, kRounding);
  for (const double next : {2.1, 0.4, 1.7}) EXPECT_NEAR(outputs(with_loop, {next}, 0.01)[0], outputs(plain, {next}, 0.01)[0], kRounding);
}

TEST(Lag, MinorLoopsOfEqualSizeAreCongruent) {
  const auto minorLoop = [](double from) {
    Lag lag(hysteresisOf(0.4, 0.1), 1);
    outputs(lag, ramp(0, from + 0.6, 60), 0.01);
    outputs(lag, ramp(from + 0.6, from, 60), 0.01);
    std::vector<double> up = outputs(lag, ramp(from, from + 0.6, 60), 0.01);
    for (double& y : up) y -= from;
    return up;
  };
  const std::vector<double> low = minorLoop(0.2), high = minorLoop(3);
  for (std::size_t n = 0; n < low.size(); ++n) EXPECT_NEAR(low[n], high[n], kRounding);
}

TEST(Lag, HysteresisIsRateIndependent) {
  Lag slow(hysteresisOf(0.4, 0.1), 1), fast(hysteresisOf(0.4, 0.1), 1);
  const std::vector<double> path{0.5, 1, 0.2, 0.9, 0};
  EXPECT_EQ(outputs(slow, path, 10), outputs(fast, path, 1e-6));
}

TEST(Lag, DelayShiftsTheOutputAndStartsAtZero) {
  Readout readout;
  readout.delay = 0.03;
  Lag lag(readout, 1);
  EXPECT_EQ(outputs(lag, {1, 2, 3, 4, 5, 6}, 0.01), (std::vector<double>{0, 0, 0, 1, 2, 3}));
  // A delay between two steps uses the older one. Steps may differ in length.
  readout.delay = 0.025;
  Lag between(readout, 1);
  EXPECT_EQ(outputs(between, {1, 2, 3, 4, 5, 6}, 0.01), (std::vector<double>{0, 0, 0, 1, 2, 3}));
  EXPECT_EQ(outputs(between, {7, 8, 9}, 0.02), (std::vector<double>{5, 6, 7}));
}

TEST(Lag, StagesAreInOrderAndTaxelsIndependent) {
  Readout readout = hysteresisOf(0.25, 0.1);
  readout.creep = {{0.5, 1}};
  readout.low_pass_time = 2;
  readout.delay = 0.5;
  Lag lag(readout, 2);
  // Hysteresis subtracts 0.25 x 0.1 from 1 N; creep and low-pass form a system with two poles.
  const double x = 1 - 0.25 * 0.1;
  std::vector<double> last;
  for (int n = 0; n < 4001; ++n) last = lag.step(std::vector<double>{1, 0}, 5e-4);
  const double t = 4001 * 5e-4 - 0.5;
  const double fast = std::exp(-t / 1), slow = std::exp(-t / 2);
  // Step response of (1 + c / (1 + s)) / (1 + 2 s), c = 0.5.
  const double expected = x * (1 - slow + 0.5 * (1 + fast - 2 * slow));
  EXPECT_NEAR(last[0], expected, 1e-3) << "creep is not resolved within a step of 0.5 ms";
  EXPECT_EQ(last[1], 0);
}

}  // namespace
}  // namespace taxelsim
