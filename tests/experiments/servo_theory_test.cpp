// Theory against recursions written out by hand and published numbers.
#include "experiments/servo_theory.h"

#include <complex>

#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kGain = 0.7824;  // 1/s: 2 % in the paper's 5 s
constexpr double kBand = 0.02;
constexpr double kPrinted = 0.0005;  // s: the numbers below have three decimals

double same(double error) {
  return error;
}

TEST(ServoTheory, ClosedFormSettlingTimes) {
  EXPECT_NEAR(closedFormSettlingTime({.gain = kGain, .dt = 0.01}, kBand), 4.980, kPrinted);
  EXPECT_NEAR(closedFormSettlingTime({.gain = kGain, .dt = 1.0 / 93, .period = 3}, kBand), 4.937, kPrinted);
  EXPECT_NEAR(closedFormSettlingTime({.gain = kGain, .dt = 0.01, .delay = 1}, kBand), 4.941, kPrinted);
  EXPECT_NEAR(closedFormSettlingTime({.gain = kGain, .dt = 1.0 / 93, .period = 3, .delay = 3}, kBand), 4.807, kPrinted);
  EXPECT_TRUE(std::isnan(closedFormSettlingTime({.gain = 150, .dt = 0.01}, kBand))) << "oscillates";
  EXPECT_TRUE(std::isnan(closedFormSettlingTime({.gain = 30, .dt = 0.01, .delay = 1}, kBand))) << "oscillates: K T is above 1/4";
  EXPECT_TRUE(std::isnan(closedFormSettlingTime({.gain = 1, .dt = 0.01, .period = 3, .delay = 1}, kBand)));
}

TEST(ServoTheory, ErrorsFollowTheirRecursion) {
  constexpr double kRounding = 1e-14;
  const std::vector<double> plain = expectedErrors({.gain = kGain, .dt = 0.01, .start_error = 0.5}, 400, same);
  const std::vector<double> late = expectedErrors({.gain = kGain, .dt = 0.01, .delay = 1, .start_error = 0.5}, 400, same);
  const std::vector<double> held = expectedErrors({.gain = kGain, .dt = 1.0 / 93, .period = 3, .start_error = 0.5}, 400, same);
  ASSERT_EQ(plain.size(), 400u);
  EXPECT_EQ(late[1], 0.5) << "delayed";
  for (std::size_t n = 0; n < 400; ++n) {
    EXPECT_NEAR(plain[n], 0.5 * std::pow(1 - kGain * 0.01, static_cast<double>(n)), kRounding);
    if (n % 3 == 0) {
      EXPECT_NEAR(held[n], 0.5 * std::pow(1 - kGain / 31, static_cast<double>(n) / 3), kRounding);
    }
    if (n >= 2) {
      EXPECT_NEAR(late[n], late[n - 1] - kGain * 0.01 * late[n - 2], kRounding);
    }
  }
  const std::vector<double> biased =
      expectedErrors({.gain = kGain, .dt = 0.01, .start_error = 0.5}, 2000, [](double e) { return e - 0.1; });
  EXPECT_NEAR(biased.back(), 0.1, 0.4 * std::exp(-kGain * 19.9)) << "a sensor that reads 0 at 0.1 leaves 0.1";
}

TEST(ServoTheory, SettlingTimeIsFoundBetweenFrames) {
  std::vector<double> errors;
  for (int n = 0; n < 1000; ++n) errors.push_back(-std::exp(-n * 0.01));
  constexpr double kRounding = 1e-9;
  EXPECT_NEAR(settlingTime(errors, 0.01, kBand), std::log(50), kRounding);
  EXPECT_EQ(settlingTime({1, 1, 1}, 0.01, 1), 0) << "never outside";
  EXPECT_TRUE(std::isnan(settlingTime({1, 0.5, 0.01, 0.5}, 0.01, kBand))) << "outside at the end";
  EXPECT_NEAR(settlingTime({1, 0.01, 0.5, -0.5, 0, 0}, 1, 0.1), 3 + 0.4 / 0.5, kRounding)
      << "last crossing; linear interpolation at a change of sign";
  EXPECT_TRUE(std::isnan(settlingTime({0, 1, 0}, 1, kBand)) || settlingTime({0, 1, 0}, 1, kBand) > 0) << "an error of 0 has no band";
  EXPECT_TRUE(std::isnan(settlingTime({}, 1, kBand)));
}

TEST(ServoTheory, GrowthIsThatOfTheRoots) {
  for (const double gain : {0.5, 0.9, 1.9, 1.99, 2.01, 2.1}) {
    const std::vector<double> errors = expectedErrors({.gain = gain, .dt = 1, .start_error = 1}, 60, same);
    EXPECT_NEAR(measuredGrowth(errors), closedFormGrowth(gain, false), 1e-9) << gain;
    EXPECT_EQ(closedFormGrowth(gain, false) < 1, gain < 2) << gain;
  }
  for (const double gain : {0.1, 0.25, 0.9, 0.98, 1.02, 1.1}) {
    const std::vector<double> errors = expectedErrors({.gain = gain, .dt = 1, .delay = 1, .start_error = 1}, 100, same);
    if (gain > 0.25) {
      // An oscillation with angle t per frame changes the mean square of a window, which weighs frame n by r^2n, by up to q.
      const double r2 = gain, t = std::acos(1 / (2 * std::sqrt(r2))), last = std::pow(r2, 33);
      const double q = std::abs(1 - r2) / std::abs(1.0 - std::polar(r2, 2 * t)) * (1 + last) / std::abs(1 - last);
      EXPECT_NEAR(measuredGrowth(errors), closedFormGrowth(gain, true), q / 67) << gain;
    }
    EXPECT_EQ(closedFormGrowth(gain, true) < 1, gain < 1) << gain;
  }
  EXPECT_EQ(closedFormGrowth(0.25, true), 0.5) << "double root";
}

TEST(ServoTheory, CharacteristicIsPiecewiseLinear) {
  const StaticCharacteristic read{.error = {-1, 0, 1}, .measured = {-2, 0, 4}};
  EXPECT_EQ(read.at(0.25), 1);
  EXPECT_EQ(read.at(-0.5), -1);
  EXPECT_EQ(read.at(1), 4);
  EXPECT_EQ(read.at(7), 4) << "clamped at the ends";
}

}  // namespace
}  // namespace taxelsim
