#include "reference/imperfections.h"

#include <cmath>

#include "base/philox.h"

namespace taxelsim::reference {
namespace {

DrawKey drawKey(const EpisodeKey& key, std::uint32_t frame, std::size_t taxel, Purpose purpose) {
  return {.seed = key.seed, .episode = key.episode, .frame = frame, .taxel = static_cast<std::uint32_t>(taxel), .purpose = purpose};
}

}  // namespace

Imperfections::Imperfections(const Readout& readout, std::size_t num_taxels, const EpisodeKey& key)
    : readout_(readout), key_(key), walk_(num_taxels, 0.0) {}

void Imperfections::step(double dt) {
  for (std::size_t t = 0; t < walk_.size(); ++t) {
    walk_[t] += readout_.random_walk * std::sqrt(dt) * gaussian(drawKey(key_, num_steps_, t, Purpose::kRandomWalk));
  }
  ++num_steps_;
}

ReadoutDraw Imperfections::draw(std::uint32_t frame) const {
  const double press_gain = key_.gain * std::exp(readout_.press_gain_spread * gaussian(drawKey(key_, 0, 0, Purpose::kPressGain)));
  const double gain_spread = std::hypot(readout_.gain_spread, key_.gain_spread);
  const double noise = std::hypot(readout_.noise, key_.noise);
  ReadoutDraw draw;
  for (std::size_t t = 0; t < walk_.size(); ++t) {
    draw.gain.push_back(press_gain * std::exp(gain_spread * gaussian(drawKey(key_, 0, t, Purpose::kTaxelGain))));
    draw.noise.push_back(noise * gaussian(drawKey(key_, frame, t, Purpose::kReadoutNoise)) +
                         readout_.bias * gaussian(drawKey(key_, 0, t, Purpose::kBias)) + walk_[t]);
    // float32, as on the device: both must agree on every taxel.
    draw.dead.push_back(uniformNumber(drawKey(key_, 0, t, Purpose::kDeadTaxel)) < static_cast<float>(readout_.dead_taxel_probability));
  }
  return draw;
}

}  // namespace taxelsim::reference
