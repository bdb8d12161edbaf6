// Counter-based random numbers: Philox4x32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011).
// A random number is a pure function of key and counter, so the order of draws, the batch size and the number of threads have no effect.
// shaders/common/philox.glsl is the GLSL version and gives the same bits.
#pragma once

#include <array>
#include <cstdint>

namespace taxelsim {

// What a random number is used for. Part of the counter, so that two uses never share a number. The shaders have the same values.
enum class Purpose : std::uint32_t {
  kReadoutNoise = 1,
  kTaxelGain = 2,
  kEpisode = 3,  // all that the host draws at the start of an episode
  kBias = 4,
  kDeadTaxel = 5,
  kRandomWalk = 6,
  kPressGain = 7,
  kJitter = 8,
  kMotion = 9,        // of objects; host only
  kActionNoise = 10,  // host only
  kEpisodeKey = 11,   // host only
  kAxisNoise = 12,    // of x, and the two after it: of y and the normal
  kTaxelTrigger = 15,
};

// The generator itself: four words, each uniform on [0, 2^32).
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

// Identifies one random number of a sensor instance, with the same counter layout as in the shaders.
struct DrawKey {
  std::uint64_t seed = 0;
  std::uint64_t episode = 0;
  std::uint32_t frame = 0;  // index of the step; 0 where the number does not change over time
  std::uint32_t taxel = 0;  // < 2^24; 0 where the number applies to the whole instance
  Purpose purpose{};
};

// Uniform on [0, 1), 24 bits.
double uniformNumber(const DrawKey& key);

// Standard normal by the Box-Muller transform; |value| < kMaxGaussian.
double gaussian(const DrawKey& key);
inline constexpr double kMaxGaussian = 5.9;  // the transform's uniform number is at least 2^-25: sqrt(2 ln 2^25) = 5.887

// Sequence of random numbers for one episode, on the host.
class EpisodeRandom {
 public:
  EpisodeRandom(std::uint64_t seed, std::uint64_t episode) : seed_(seed), episode_(episode) {}

  // Uniform on [0, 1), 53 bits.
  double uniform();
  // Uniform on [min, max]; min when they are equal.
  double uniform(double min, double max) { return min + (max - min) * uniform(); }

 private:
  std::uint64_t seed_;
  std::uint64_t episode_;
  std::uint32_t next_ = 0;
};

}  // namespace taxelsim
