// Counter-based random numbers: Philox4x32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011).
// A draw is a pure function of its key and counter, so order, batch size and threads never show. shaders/common/philox.glsl is the same
// function.
#pragma once

#include <array>
#include <cstdint>

namespace taxelsim {

// What a draw is for; one counter word, so that two uses never share a number. The shaders use the same values.
enum class Purpose : std::uint32_t {
  kReadoutNoise = 1,
  kTaxelGain = 2,
  kEpisode = 3,  // everything drawn on the host at the start of an episode
  kBias = 4,
  kDeadTaxel = 5,
  kRandomWalk = 6,
  kPressGain = 7,
  kJitter = 8,
  kMotion = 9,        // of objects; on the host only
  kActionNoise = 10,  // on the host only
};

// Four words, uniform on [0, 2^32).
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

// One draw of a sensor instance, as the shaders make it for a taxel. `frame` is the step or 0 where the purpose has no frame, `taxel`
// 0 where it is of the whole instance.
struct DrawKey {
  std::uint64_t seed = 0;
  std::uint64_t episode = 0;
  std::uint32_t frame = 0;
  std::uint32_t taxel = 0;  // below 2^24
  Purpose purpose{};
};

// Uniform on [0, 1), 24 bits.
double uniformNumber(const DrawKey& key);

// Standard normal (Box and Muller), never farther out than kLargestGaussian.
double gaussian(const DrawKey& key);
inline constexpr double kLargestGaussian = 5.9;  // sqrt(2 ln 2^25) = 5.887

// The draws of one episode, numbered by the order in which they are asked for.
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
