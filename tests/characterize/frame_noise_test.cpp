// Noise and drift of readings from the frames of a recording, without a fit.
#include "characterize/frame_noise.h"

#include "characterize/stamp_recording.h"
#include "stamp_bench.h"

namespace taxelsim::testing {
namespace {

// Images under a press whose offsets drift, each taxel by itself.
StampImages drifting(const Press& press, double walk) {
  StampImages stamp = recorded(baseSensor(), press);
  std::mt19937 random(static_cast<unsigned>(press.seed));
  std::normal_distribution<double> step(0, walk * std::sqrt(kFrame));
  std::vector<double> offset(stamp.images.num_taxels);
  for (std::size_t row = 0; row < stamp.images.time.size(); ++row) {
    for (std::size_t t = 0; t < offset.size(); ++t) {
      float& counts = stamp.images.counts[row * offset.size() + t];
      offset[t] += step(random);
      if (counts > 0) counts = std::round(counts + static_cast<float>(offset[t]));
    }
  }
  return stamp;
}

FrameNoise noiseOfRecordings(double noise, double walk, std::uint64_t seed) {
  std::vector<StampImages> images;
  for (std::uint64_t n = 0; n < 3; ++n)
    images.push_back(drifting({.load = 5 + static_cast<double>(n), .noise = noise, .seed = 10 * seed + n}, walk));
  const std::vector<Measurement> measurements = measured(baseSensor(), images);
  std::vector<Stamp> stamps;
  for (const Measurement& measurement : measurements) stamps.push_back(stampOf(measurement));
  return frameNoiseOf(stamps, 4095);
}

// Of 200 planted benches each, 95 % are covered: 179 to 199 with a probability of 0.9997 (binomial).
TEST(FrameNoise, IntervalsCoverPlantedNoiseAndDrift) {
  for (const auto& [noise, walk] : {std::pair{5.0, 0.0}, {17.0, 6.0}, {8.0, 12.0}}) {
    int covers_noise = 0, covers_walk = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      const FrameNoise found = noiseOfRecordings(noise, walk, seed);
      ASSERT_GE(found.num_series, 20u);
      covers_noise += std::abs(found.variance - noise * noise) <= found.variance_half;
      covers_walk += std::abs(found.walk - walk * walk) <= found.walk_half;
    }
    std::printf("noise %g, walk %g: %d and %d of 200 covered\n", noise, walk, covers_noise, covers_walk);
    for (const int covered : {covers_noise, covers_walk}) {
      EXPECT_GE(covered, 179) << noise << " " << walk;
      EXPECT_LE(covered, 199) << noise << " " << walk;
    }
  }
}

TEST(FrameNoise, NeedsFramesThatAreNotClipped) {
  const std::vector<StampImages> images{recorded(baseSensor(), {.load = 100})};
  const std::vector<Measurement> measurements = measured(baseSensor(), images);
  const std::vector<Stamp> stamps{stampOf(measurements[0])};
  EXPECT_EQ(frameNoiseOf(stamps, 1).num_series, 0u);
}

}  // namespace
}  // namespace taxelsim::testing
