// Stage 4 in double precision against closed forms.
#include "reference/lag.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_scene.h"

namespace taxelsim {
namespace {

using reference::Lag;

// Some thousand roundings of numbers of order one.
constexpr double kRounding = 1e-12;

// What one taxel shows after each force of a path, a step of dt apart.
std::vector<double> shown(Lag& lag, const std::vector<double>& path, double dt) {
  std::vector<double> result;
  for (const double force : path) result.push_back(lag.step(std::vector<double>{force}, dt)[0]);
  return result;
}

// From `from` to `to` in `num_steps` equal parts, without `from`.
std::vector<double> ramp(double from, double to, int num_steps) {
  std::vector<double> path;
  for (int n = 1; n <= num_steps; ++n) path.push_back(from + (to - from) * n / num_steps);
  return path;
}

// Area between the output's branches over the input, by trapezia: exact for straight pieces that end at steps.
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

TEST(Lag, OffIsTheForceItself) {
  Lag lag(Readout{}, 2);
  EXPECT_EQ(lag.step(std::vector<double>{1.25, 3}, 0.1), (std::vector<double>{1.25, 3}));
}

TEST(Lag, CreepAtConstantForce) {
  Readout readout;
  readout.creep = {{0.1, 0.5}, {0.2, 9}};
  // Whatever the steps: the filter is exact for a force held over each.
  for (const double dt : {1e-3, 0.05, 3.0}) {
    Lag lag(readout, 1);
    const std::vector<double> force = shown(lag, std::vector<double>(200, 2.0), dt);
    for (std::size_t n = 0; n < force.size(); ++n) {
      const double t = dt * static_cast<double>(n + 1);
      EXPECT_NEAR(force[n], 2 * (1 + 0.1 * (1 - std::exp(-t / 0.5)) + 0.2 * (1 - std::exp(-t / 9))), kRounding);
    }
  }
}

TEST(Lag, LowPassOfAStepAndBack) {
  Readout readout;
  readout.low_pass_time = 0.3;
  Lag lag(readout, 1);
  const std::vector<double> up = shown(lag, std::vector<double>(50, 1.0), 0.01), down = shown(lag, std::vector<double>(50, 0.0), 0.01);
  for (int n = 0; n < 50; ++n) {
    const double left = std::exp(-0.01 * (n + 1) / 0.3);
    EXPECT_NEAR(up[n], 1 - left, kRounding);
    EXPECT_NEAR(down[n], up.back() * left, kRounding);
  }
}

// A closed path of amplitude A about its middle encloses 4 w r (A - r): the gap of 2 w r between the branches, over 2 A less the two
// slanted ends.
TEST(Lag, HysteresisLoopArea) {
  for (const double width : {0.05, 0.2, 0.4}) {
    const double strength = 0.3, amplitude = 0.5;
    Lag lag(hysteresisOf(strength, width), 1);
    shown(lag, ramp(0, 2 * amplitude, 100), 0.01);
    std::vector<double> input = ramp(2 * amplitude, 0, 100);
    const std::vector<double> up = ramp(0, 2 * amplitude, 100);
    input.insert(input.end(), up.begin(), up.end());
    input.insert(input.begin(), 2 * amplitude);
    const std::vector<double> output = shown(lag, input, 0.01);
    EXPECT_NEAR(loopArea(input, output), 4 * strength * width * (amplitude - width), kRounding);
    if (2 * width > amplitude) continue;  // the ends meet before the middle
    EXPECT_NEAR(output[50] - output[150], 2 * strength * width, kRounding) << "the gap in the middle";
  }
}

// A minor loop closes where it began and leaves nothing behind (the wiping-out property of Preisach operators).
TEST(Lag, HysteresisRemembersWhereItTurned) {
  Readout readout;
  readout.hysteresis_strength = {0.2, 0.1, 0.3};
  readout.hysteresis_width = {0.05, 0.15, 0.4};
  Lag plain(readout, 1), with_loop(readout, 1);
  for (Lag* lag : {&plain, &with_loop}) shown(*lag, ramp(0, 2, 40), 0.01);
  const double before = shown(with_loop, {2.0}, 0.01)[0];
  shown(with_loop, ramp(2, 1.3, 30), 0.01);
  EXPECT_NEAR(shown(with_loop, ramp(1.3, 2, 30), 0.01).back(), before, kRounding);
  for (const double next : {2.1, 0.4, 1.7}) EXPECT_NEAR(shown(with_loop, {next}, 0.01)[0], shown(plain, {next}, 0.01)[0], kRounding);
}

TEST(Lag, MinorLoopsOfOneSizeAreCongruent) {
  const auto minorLoop = [](double from) {
    Lag lag(hysteresisOf(0.4, 0.1), 1);
    shown(lag, ramp(0, from + 0.6, 60), 0.01);
    shown(lag, ramp(from + 0.6, from, 60), 0.01);
    std::vector<double> up = shown(lag, ramp(from, from + 0.6, 60), 0.01);
    for (double& y : up) y -= from;
    return up;
  };
  const std::vector<double> low = minorLoop(0.2), high = minorLoop(3);
  for (std::size_t n = 0; n < low.size(); ++n) EXPECT_NEAR(low[n], high[n], kRounding);
}

TEST(Lag, HysteresisDoesNotKnowTime) {
  Lag slow(hysteresisOf(0.4, 0.1), 1), fast(hysteresisOf(0.4, 0.1), 1);
  const std::vector<double> path{0.5, 1, 0.2, 0.9, 0};
  EXPECT_EQ(shown(slow, path, 10), shown(fast, path, 1e-6));
}

TEST(Lag, DelayIsThatManyStepsAndNothingComesBefore) {
  Readout readout;
  readout.delay = 0.03;
  Lag lag(readout, 1);
  EXPECT_EQ(shown(lag, {1, 2, 3, 4, 5, 6}, 0.01), (std::vector<double>{0, 0, 0, 1, 2, 3}));
  // Between two steps: the older one. Steps may differ.
  readout.delay = 0.025;
  Lag between(readout, 1);
  EXPECT_EQ(shown(between, {1, 2, 3, 4, 5, 6}, 0.01), (std::vector<double>{0, 0, 0, 1, 2, 3}));
  EXPECT_EQ(shown(between, {7, 8, 9}, 0.02), (std::vector<double>{5, 6, 7}));
}

TEST(Lag, StagesComeInOrderAndTaxelsApart) {
  Readout readout = hysteresisOf(0.25, 0.1);
  readout.creep = {{0.5, 1}};
  readout.low_pass_time = 2;
  readout.delay = 0.5;
  Lag lag(readout, 2);
  // Hysteresis takes 0.25 x 0.1 off 1 N; creep and low-pass follow from the system's two poles.
  const double x = 1 - 0.25 * 0.1;
  std::vector<double> last;
  for (int n = 0; n < 4001; ++n) last = lag.step(std::vector<double>{1, 0}, 5e-4);
  const double t = 4001 * 5e-4 - 0.5;
  const double fast = std::exp(-t / 1), slow = std::exp(-t / 2);
  // Step response of (1 + c / (1 + s)) / (1 + 2 s), c = 0.5.
  const double expected = x * (1 - slow + 0.5 * (1 + fast - 2 * slow));
  EXPECT_NEAR(last[0], expected, 1e-3) << "creep moves within a step of 0.5 ms, on 1 s";
  EXPECT_EQ(last[1], 0);
}

}  // namespace
}  // namespace taxelsim
