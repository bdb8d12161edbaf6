// Distributions of the random part of stage 5. tests/simulation/imperfections_test.cpp compares the device with these draws.
#include "reference/imperfections.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::EpisodeKey;
using reference::Imperfections;
using reference::ReadoutDraw;

// Tolerance in standard errors. Seeds are fixed, so the tests are deterministic.
constexpr double kErrors = 5;
constexpr std::uint64_t kSeed = 12;

struct Moments {
  double mean = 0, deviation = 0;
};

Moments momentsOf(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  Moments m;
  for (const double v : values) m.mean += v / n;
  for (const double v : values) m.deviation += (v - m.mean) * (v - m.mean) / (n - 1);
  m.deviation = std::sqrt(m.deviation);
  return m;
}

// Standard errors of a normal sample: s / sqrt(n) for the mean, s / sqrt(2 n) for the standard deviation.
void expectNormalMoments(const std::vector<double>& values, double mean, double deviation) {
  const auto n = static_cast<double>(values.size());
  const Moments m = momentsOf(values);
  EXPECT_NEAR(m.mean, mean, kErrors * deviation / std::sqrt(n));
  EXPECT_NEAR(m.deviation, deviation, kErrors * deviation / std::sqrt(2 * n));
}

double normalCdf(double x) {
  return std::erfc(-x / std::numbers::sqrt2) / 2;
}

// Chi-square over 20 bins of equal probability: 19 degrees of freedom, mean 19, standard deviation sqrt(38).
void expectNormalShape(const std::vector<double>& values, double deviation) {
  constexpr int kNumBins = 20;
  std::vector<int> bins(kNumBins, 0);
  for (const double v : values) ++bins[std::min(kNumBins - 1, static_cast<int>(kNumBins * normalCdf(v / deviation)))];
  const double expected = static_cast<double>(values.size()) / kNumBins;
  double chi_square = 0;
  for (const int count : bins) chi_square += (count - expected) * (count - expected) / expected;
  EXPECT_LT(chi_square, 19 + kErrors * std::sqrt(38));
  EXPECT_GT(chi_square, 1) << "too even to be random";
}

std::vector<double> offsets(const Readout& readout, std::size_t num_taxels, std::uint64_t episode, std::uint32_t frame = 0) {
  return Imperfections(readout, num_taxels, {.seed = kSeed, .episode = episode}).draw(frame).noise;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const Moments ma = momentsOf(a), mb = momentsOf(b);
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += (a[n] - ma.mean) * (b[n] - mb.mean);
  return sum / static_cast<double>(a.size()) / ma.deviation / mb.deviation;
}

TEST(Imperfections, BiasIsNormalAndConstantWithinAnEpisode) {
  Readout readout;
  readout.bias = 7;
  const std::vector<double> first = offsets(readout, 10'000, 3), second = offsets(readout, 10'000, 4);
  expectNormalMoments(first, 0, 7);
  expectNormalShape(first, 7);
  EXPECT_EQ(offsets(readout, 10'000, 3, 55), first);
  EXPECT_LT(std::abs(correlation(first, second)), kErrors / 100);  // 1 / sqrt(10,000)
}

TEST(Imperfections, NoiseIsNormalAndIndependentBetweenFrames) {
  Readout readout;
  readout.noise = 3;
  const std::vector<double> first = offsets(readout, 10'000, 3, 0), second = offsets(readout, 10'000, 3, 1);
  expectNormalMoments(first, 0, 3);
  expectNormalShape(first, 3);
  EXPECT_LT(std::abs(correlation(first, second)), kErrors / 100);
}

TEST(Imperfections, NoiseAndBiasAreUncorrelated) {
  Readout noisy, biased;
  noisy.noise = biased.bias = 1;
  EXPECT_LT(std::abs(correlation(offsets(noisy, 10'000, 3), offsets(biased, 10'000, 3))), kErrors / 100);
}

TEST(Imperfections, RandomWalkDeviationGrowsWithSquareRootOfTime) {
  Readout readout;
  readout.random_walk = 2;
  Imperfections walk(readout, 10'000, {.seed = kSeed});
  std::vector<double> before(10'000, 0.0);
  double t = 0;
  for (const double dt : {0.5, 0.01, 0.01, 2.0, 0.25}) {
    walk.step(dt);
    t += dt;
    const std::vector<double> now = walk.draw(0).noise;
    expectNormalMoments(now, 0, 2 * std::sqrt(t));
    std::vector<double> increment;
    for (std::size_t n = 0; n < now.size(); ++n) increment.push_back(now[n] - before[n]);
    expectNormalMoments(increment, 0, 2 * std::sqrt(dt));
    if (t > dt) {
      EXPECT_LT(std::abs(correlation(increment, before)), kErrors / 100);
    }
    before = now;
  }
}

TEST(Imperfections, DeadTaxelsOccurWithTheirProbability) {
  for (const double probability : {0.001, 0.05, 0.5}) {
    Readout readout;
    readout.dead_taxel_probability = probability;
    const ReadoutDraw draw = Imperfections(readout, 100'000, {.seed = kSeed, .episode = 8}).draw(0);
    const auto num_dead = static_cast<double>(std::count(draw.dead.begin(), draw.dead.end(), true));
    EXPECT_NEAR(num_dead, 1e5 * probability, kErrors * std::sqrt(1e5 * probability * (1 - probability)));
  }
  Readout never, always;
  always.dead_taxel_probability = 1;
  const auto all = Imperfections(always, 1000, {}).draw(0).dead, none = Imperfections(never, 1000, {}).draw(0).dead;
  EXPECT_EQ(std::count(all.begin(), all.end(), true), 1000);
  EXPECT_EQ(std::count(none.begin(), none.end(), true), 0);
}

TEST(Imperfections, TaxelGainsAreLogNormalWithSpreadsAddedInQuadrature) {
  Readout readout;
  readout.gain_spread = 0.03;
  const ReadoutDraw draw = Imperfections(readout, 10'000, {.seed = kSeed, .gain = 2, .gain_spread = 0.04}).draw(0);
  std::vector<double> logs;
  for (const double gain : draw.gain) logs.push_back(std::log(gain));
  expectNormalMoments(logs, std::log(2.0), 0.05);
}

// E[e^(s R)], R the range of n standard normal numbers, from the density of R, n (n-1) int phi(x) phi(x+r) [Phi(x+r) - Phi(x)]^(n-2) dx.
double expectedRatio(double s, int n) {
  const auto phi = [](double x) { return std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi); };
  constexpr double kStep = 0.02;
  double sum = 0;
  for (double r = kStep / 2; r < 10; r += kStep) {
    for (double x = -8; x < 8; x += kStep) {
      sum += std::exp(s * r) * phi(x) * phi(x + r) * std::pow(normalCdf(x + r) - normalCdf(x), n - 2);
    }
  }
  return sum * n * (n - 1) * kStep * kStep;
}

// Repeatability of Kappassov et al., AIM 2020, figure 6a: repeated presses of 1.5 N scatter by up to 1.5 times.
TEST(Imperfections, RepeatabilityOfFivePressesMatchesThePaper) {
  constexpr double kSpread = 0.174;
  constexpr int kNumPresses = 5, kNumSets = 4000;
  constexpr double kMeanRange = 2.3259, kRangeDeviation = 0.8641;  // d2 and d3 for n = 5, control chart constants
  Readout readout;
  readout.press_gain_spread = kSpread;
  std::vector<double> logs, ratios;
  for (int set = 0; set < kNumSets; ++set) {
    double smallest = 1e9, largest = 0;
    for (int press = 0; press < kNumPresses; ++press) {
      const auto episode = static_cast<std::uint64_t>(kNumPresses * set + press);
      const ReadoutDraw draw = Imperfections(readout, 2, {.seed = kSeed, .episode = episode}).draw(0);
      EXPECT_EQ(draw.gain[0], draw.gain[1]) << "common to all taxels";
      smallest = std::min(smallest, draw.gain[0]);
      largest = std::max(largest, draw.gain[0]);
    }
    ratios.push_back(largest / smallest);
    logs.push_back(std::log(largest / smallest));
  }
  const double log_error = kSpread * kRangeDeviation / std::sqrt(kNumSets);
  EXPECT_NEAR(momentsOf(logs).mean, kMeanRange * kSpread, kErrors * log_error);
  EXPECT_NEAR(std::exp(momentsOf(logs).mean), 1.5, 1.5 * kErrors * log_error);
  const Moments ratio = momentsOf(ratios);
  EXPECT_NEAR(ratio.mean, expectedRatio(kSpread, kNumPresses), kErrors * ratio.deviation / std::sqrt(kNumSets));
}

}  // namespace
}  // namespace taxelsim
