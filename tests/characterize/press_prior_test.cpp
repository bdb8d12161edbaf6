// Gains of presses that depend on their load: Gaussian process against its closed form, the choice of its size, and the fit of a bench.
#include "characterize/press_prior.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "base/philox.h"
#include "characterize/estimates.h"
#include "characterize/stamp_bench.h"
#include "support/test.h"
#include "taxelsim/characterize.h"

namespace taxelsim::testing {
namespace {

using support::estimateOf;
using support::findEstimate;

constexpr double kRounding = 1e-12;  // of values of order 1 in double

double gaussianOf(std::uint64_t seed, int index) {
  return gaussian({.seed = seed, .frame = 0, .taxel = static_cast<std::uint32_t>(index), .purpose = Purpose::kReadoutNoise});
}

TEST(PressPrior, CovarianceByHand) {
  const PressPrior prior{.load_spread = 0.2, .length = 0.5, .press_spread = 0.1};
  const Eigen::MatrixXd found = prior.covariance({2, 2, 4});
  const double far = 0.04 * std::exp(-std::pow(std::log(2) / 0.5, 2) / 2);
  EXPECT_NEAR(found(0, 0), 0.05, kRounding);
  EXPECT_NEAR(found(0, 1), 0.04, kRounding) << "presses of one load share the process";
  EXPECT_NEAR(found(1, 2), far, kRounding);
  EXPECT_NEAR(found(2, 0), far, kRounding);
}

// One press: v = k / (k + p) times its deviation, shrunk with the distance. Two presses of one load count as their mean.
TEST(PressPrior, ExpectedGainsByHand) {
  const BenchGains one{.loads = {2, 8}, .log_gains = {0.3, 0}, .load_spread = 0.2, .length = 0.01, .press_spread = 0.1};
  EXPECT_NEAR(one.at(2), 0.3 * 0.04 / 0.05, kRounding);
  EXPECT_NEAR(one.at(2.02), 0.3 * 0.04 / 0.05 * std::exp(-std::pow(std::log(1.01) / 0.01, 2) / 2), kRounding);
  EXPECT_NEAR(one.at(4), 0, kRounding) << "far from both";
  EXPECT_EQ(one.at(1.9), 0) << "beyond the loads of the presses";
  EXPECT_EQ(one.at(8.1), 0);
  const BenchGains two{.loads = {2, 2, 8}, .log_gains = {0.2, 0.4, 0}, .load_spread = 0.2, .length = 0.01, .press_spread = 0.1};
  EXPECT_NEAR(two.at(2), 0.3 * 0.04 / (0.04 + 0.01 / 2), kRounding);
}

// Gains that are known exactly, up to a standard deviation of 1e-4: the prior is found from draws of it. 95 % of the draws must have the
// true form; with 40 seeds at least 35 (four standard deviations are 1.4 x 4 = 5.5).
TEST(PressPrior, TheEvidenceTellsAProcessFromIndependentPresses) {
  std::vector<double> loads;
  for (int n = 0; n < 16; ++n) loads.push_back(2 + n / 2);
  const double range = std::log(loads.back() / loads.front());
  const PressPrior process{.load_spread = 0.13, .length = 0.3 * range, .press_spread = 0.02};
  const PressPrior independent{.load_spread = 0, .length = range, .press_spread = 0.09};
  const PressPrior wide{.load_spread = 0, .length = range, .press_spread = 0.35};
  const Eigen::MatrixXd known = 1e-8 * Eigen::MatrixXd::Identity(16, 16);
  constexpr double kAccepted = 4.6;  // of stamp_selection.cpp
  int found_process = 0, found_independent = 0;
  for (int seed = 0; seed < 40; ++seed) {
    Eigen::VectorXd normal(16);
    for (int i = 0; i < 16; ++i) normal[i] = gaussianOf(300 + static_cast<std::uint64_t>(seed), i);
    const auto choiceFrom = [&](const PressPrior& truth) {
      const Eigen::VectorXd drawn = truth.covariance(loads).llt().matrixL() * normal;
      return choosePressPrior(loads, drawn, known, wide);
    };
    found_process += choiceFrom(process).gain > kAccepted ? 1 : 0;
    found_independent += choiceFrom(independent).gain <= kAccepted ? 1 : 0;
  }
  EXPECT_GE(found_process, 35);
  EXPECT_GE(found_independent, 35);
}

// Readings u + noise of a known variance have the density N(0, prior + noise): the evidence without integrals over posteriors, whichever
// prior the fit had used.
TEST(PressPrior, TheEvidenceIsTheDensityOfTheReadings) {
  const std::vector<double> loads{2, 2, 3, 3, 4, 4, 5, 5, 6, 6};
  const Eigen::MatrixXd noise = 0.05 * 0.05 * Eigen::MatrixXd::Identity(10, 10);
  Eigen::VectorXd normal(10);
  for (int i = 0; i < 10; ++i) normal[i] = gaussianOf(7, i);
  const Eigen::VectorXd readings =
      (PressPrior{.load_spread = 0.2, .length = 0.4, .press_spread = 0.03}.covariance(loads) + noise).llt().matrixL() * normal;
  const double range = std::log(3);
  double best = -1e300, without = -1e300;
  const auto weigh = [&](const PressPrior& prior) {
    const Eigen::MatrixXd covariance = prior.covariance(loads) + noise;
    const double density = -readings.dot(covariance.inverse() * readings) / 2 - std::log(covariance.determinant()) / 2;
    best = std::max(best, density);
    if (prior.load_spread == 0) without = std::max(without, density);
  };
  const std::vector<double> spreads{0.02, 0.03, 0.045, 0.065, 0.09, 0.13, 0.18, 0.25, 0.35};
  const std::vector<double> press_spreads{0.005, 0.01, 0.015, 0.02, 0.03, 0.045, 0.065, 0.09, 0.13};
  for (const double spread : spreads) weigh({.load_spread = 0, .length = range, .press_spread = spread});
  for (const double press : press_spreads) {
    weigh({.load_spread = 0, .length = range, .press_spread = press});
    for (const double spread : spreads) {
      for (const double part : {0.1, 0.15, 0.2, 0.3, 0.45, 0.65})
        weigh({.load_spread = spread, .length = part * range, .press_spread = press});
    }
  }
  for (const PressPrior& used : {PressPrior{.load_spread = 0, .length = 1, .press_spread = 0.05},
                                 PressPrior{.load_spread = 0.3, .length = 0.2, .press_spread = 0.1}}) {
    const Eigen::MatrixXd posterior = (noise.inverse() + used.covariance(loads).inverse()).inverse();
    const PressPriorChoice choice = choosePressPrior(loads, posterior * (noise.inverse() * readings), posterior, used);
    EXPECT_NEAR(choice.gain, best - without, 1e-6) << "log evidence; inverses of matrices with a condition of 1e4";
  }
  EXPECT_GT(best - without, 1);
}

std::vector<StampImages> pressedWith(const Sensor& truth, const std::vector<double>& gains) {
  std::vector<StampImages> stamps;
  for (std::size_t n = 0; n < gains.size(); ++n) {
    stamps.push_back(recorded(truth, {.load = 2.0 + static_cast<double>(n / 2), .x = 0.5e-3, .gain = gains[n], .seed = 210 + n}));
    stamps.back().fixture = "holder";
  }
  return stamps;
}

// Loads share deviations of 20 %: the fit finds the deviations of the presses from their mean, weighted by the counts, and predicts that
// of a load that was not pressed.
TEST(PressPrior, AFitFindsTheDeviationsOfABench) {
  const Sensor truth = baseSensor();
  std::vector<double> gains;
  for (int n = 0; n < 16; ++n) gains.push_back(std::exp(0.2 * std::sin(1.1 * (n / 2)) + 0.02 * gaussianOf(5, n)));
  const std::vector<StampImages> stamps = pressedWith(truth, gains);
  const Characterization result = fitted(truth, stamps);
  ASSERT_TRUE(result.bench_gains);
  const BenchGains& bench = *result.bench_gains;
  ASSERT_EQ(bench.loads.size(), 16u);
  double counts = 0, mean = 0;
  for (std::size_t n = 0; n < 16; ++n) {
    counts += bench.loads[n] * gains[n];
    mean += bench.loads[n] * gains[n] * std::log(gains[n]);
  }
  for (std::size_t n = 0; n < 16; ++n) {
    // Presses scatter by 2 %, and the trigger shifts the sums of light loads by about as much.
    EXPECT_NEAR(bench.log_gains[n], std::log(gains[n]) - mean / counts, 0.04) << bench.loads[n] << " N";
  }
  // Their mean, weighted by the counts, is the gain of the sensor.
  double weighted = 0, all = 0;
  for (std::size_t n = 0; n < 16; ++n) {
    const double counts_of_press = std::accumulate(stamps[n].images.counts.begin(), stamps[n].images.counts.end(), 0.0);
    weighted += counts_of_press * bench.log_gains[n], all += counts_of_press;
  }
  EXPECT_NEAR(weighted / all, 0, 1e-3) << "creep changes the counts of all presses alike, but for the trigger";
  EXPECT_NEAR(bench.at(6.5), 0.2 * std::sin(1.1 * 4.5) - mean / counts, 0.06);
  EXPECT_TRUE(estimateOf(result, "bench.load_gain_spread").determined);
  EXPECT_LT(result.sensor.readout.press_gain_spread, 0.07) << "the scatter between presses of one load alone";
}

TEST(PressPrior, IndependentPressesStayIndependent) {
  const Sensor truth = baseSensor();
  std::vector<double> gains;
  for (int n = 0; n < 16; ++n) gains.push_back(std::exp(0.08 * gaussianOf(9, n)));
  const Characterization result = fitted(truth, pressedWith(truth, gains));
  EXPECT_FALSE(result.bench_gains);
  EXPECT_EQ(findEstimate(result, "bench.load_gain_spread"), nullptr);
  EXPECT_NEAR(result.sensor.readout.press_gain_spread, 0.08, 0.05) << "three standard deviations of that of 16 values";
}

}  // namespace
}  // namespace taxelsim::testing
