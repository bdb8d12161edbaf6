#include "base/philox.h"

#include <cmath>
#include <numbers>

namespace taxelsim {
namespace {

constexpr std::uint64_t kMultiplier0 = 0xD2511F53u;
constexpr std::uint64_t kMultiplier1 = 0xCD9E8D57u;
constexpr std::uint32_t kWeyl0 = 0x9E3779B9u;
constexpr std::uint32_t kWeyl1 = 0xBB67AE85u;
constexpr int kRounds = 10;

std::array<std::uint32_t, 4> randomWords(const DrawKey& key) {
  return philox({static_cast<std::uint32_t>(key.episode), static_cast<std::uint32_t>(key.episode >> 32), key.frame,
                 key.taxel | static_cast<std::uint32_t>(key.purpose) << 24},
                {static_cast<std::uint32_t>(key.seed), static_cast<std::uint32_t>(key.seed >> 32)});
}

}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < kRounds; ++round) {
    const std::uint64_t product0 = kMultiplier0 * counter[0];
    const std::uint64_t product1 = kMultiplier1 * counter[2];
    counter = {static_cast<std::uint32_t>(product1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(product1),
               static_cast<std::uint32_t>(product0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(product0)};
    key[0] += kWeyl0;
    key[1] += kWeyl1;
  }
  return counter;
}

double uniformNumber(const DrawKey& key) {
  return static_cast<double>(randomWords(key)[0] >> 8) * 0x1p-24;
}

double gaussian(const DrawKey& key) {
  const std::array<std::uint32_t, 4> words = randomWords(key);
  const double u = (static_cast<double>(words[0] >> 8) + 0.5) * 0x1p-24;
  const double angle = static_cast<double>(words[1] >> 8) * 0x1p-24 * 2 * std::numbers::pi;
  return std::sqrt(-2 * std::log(u)) * std::cos(angle);
}

double EpisodeRandom::uniform() {
  const std::array<std::uint32_t, 4> words = philox({static_cast<std::uint32_t>(episode_), static_cast<std::uint32_t>(episode_ >> 32),
                                                     next_++, static_cast<std::uint32_t>(Purpose::kEpisode) << 24},
                                                    {static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32)});
  const std::uint64_t bits = (static_cast<std::uint64_t>(words[0]) << 21) ^ (words[1] >> 11);
  return static_cast<double>(bits & ((std::uint64_t{1} << 53) - 1)) * 0x1p-53;
}

}  // namespace taxelsim
