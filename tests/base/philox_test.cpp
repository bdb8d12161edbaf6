#include "base/philox.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using Words = std::array<std::uint32_t, 4>;

// Known answers for philox4x32-10 from the Random123 distribution (tests/kat_vectors).
TEST(Philox, MatchesRandom123KnownAnswers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}), (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(EpisodeRandom, IsAFunctionOfSeedAndEpisode) {
  EpisodeRandom first(7, 9);
  EpisodeRandom again(7, 9);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(first.uniform(), again.uniform());
}

TEST(EpisodeRandom, DifferentSeedsAndEpisodesGiveDifferentNumbers) {
  std::set<double> draws;
  // Includes seeds and episodes that differ in the upper 32 bits only.
  for (const std::uint64_t seed : {0ull, 1ull, 1ull << 32, ~0ull}) {
    for (const std::uint64_t episode : {0ull, 1ull, 1ull << 32, ~0ull}) {
      EpisodeRandom random(seed, episode);
      for (int i = 0; i < 10; ++i) draws.insert(random.uniform());
    }
  }
  EXPECT_EQ(draws.size(), 160u);
}

TEST(EpisodeRandom, IsUniform) {
  constexpr int kNumDraws = 100000;
  // Five standard deviations of the mean, 1 / sqrt(12 n), and of the mean square, sqrt(4 / 45 / n).
  const double mean_tolerance = 5 / std::sqrt(12.0 * kNumDraws);
  const double square_tolerance = 5 * std::sqrt(4.0 / 45 / kNumDraws);
  EpisodeRandom random(1, 2);
  double sum = 0;
  double sum_of_squares = 0;
  for (int i = 0; i < kNumDraws; ++i) {
    const double draw = random.uniform();
    ASSERT_GE(draw, 0);
    ASSERT_LT(draw, 1);
    sum += draw;
    sum_of_squares += draw * draw;
  }
  EXPECT_NEAR(sum / kNumDraws, 0.5, mean_tolerance);
  EXPECT_NEAR(sum_of_squares / kNumDraws, 1.0 / 3, square_tolerance);
}

TEST(EpisodeRandom, StaysWithinTheGivenRange) {
  EpisodeRandom random(3, 4);
  for (int i = 0; i < 1000; ++i) {
    const double draw = random.uniform(-2, 5);
    EXPECT_GE(draw, -2);
    EXPECT_LE(draw, 5);
  }
  EXPECT_EQ(random.uniform(0.25, 0.25), 0.25);
}

}  // namespace
}  // namespace taxelsim
