#include "reference/three_axis.h"

#include <algorithm>
#include <cmath>

#include "base/philox.h"
#include "reference/readout.h"

namespace taxelsim::reference {
namespace {

double normal(const EpisodeKey& key, std::uint32_t frame, std::size_t taxel, std::uint32_t purpose) {
  return gaussian({.seed = key.seed,
                   .episode = key.episode,
                   .frame = frame,
                   .taxel = static_cast<std::uint32_t>(taxel),
                   .purpose = static_cast<Purpose>(purpose)});
}

}  // namespace

ThreeAxis::ThreeAxis(const Sensor& sensor, const EpisodeKey& key)
    : sensor_(sensor), key_(key), play_(static_cast<std::size_t>(numTaxels(sensor)), Vector3{0, 0, 0}) {}

std::vector<std::int32_t> ThreeAxis::step(std::span<const Vector3> force, std::uint32_t frame) {
  const Readout& readout = sensor_.readout;
  const ThreeAxisReadout& axes = *readout.three_axis;
  const double press_gain =
      key_.gain * std::exp(readout.press_gain_spread * normal(key_, 0, 0, static_cast<std::uint32_t>(Purpose::kPressGain)));
  const double spread = std::hypot(readout.gain_spread, key_.gain_spread);
  std::vector<std::int32_t> counts;
  for (std::size_t t = 0; t < force.size(); ++t) {
    Vector3 read;
    for (std::size_t b = 0; b < 3; ++b) {
      double& play = play_[t][b];
      play = std::clamp(play, force[t][b] - axes.hysteresis_width[b], force[t][b] + axes.hysteresis_width[b]);
      read[b] = (1 - axes.hysteresis_strength[b]) * force[t][b] + axes.hysteresis_strength[b] * play;
    }
    const double gain =
        press_gain * gainOf(readout, t) * std::exp(spread * normal(key_, 0, t, static_cast<std::uint32_t>(Purpose::kTaxelGain)));
    for (std::uint32_t a = 0; a < 3; ++a) {
      const double signal = axes.gain[a][0] * read[0] + axes.gain[a][1] * read[1] + axes.gain[a][2] * read[2];
      const double noise = axes.noise[a] * normal(key_, frame, t, static_cast<std::uint32_t>(Purpose::kAxisNoise) + a);
      const double limit = axes.saturation;
      counts.push_back(static_cast<std::int32_t>(std::clamp(std::floor(gain * signal + noise + 0.5), -limit, limit)));
    }
  }
  return counts;
}

}  // namespace taxelsim::reference
