// Stage 5 of the reference, random part: gains, noise, bias, random walk and dead taxels of one instance in one episode.
//
// Random numbers are counter-based (base/philox.h), keyed by (seed, episode, frame, taxel, purpose): the device draws the same numbers, and
// none of them depends on the batch or on what was drawn before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reference/readout.h"

namespace taxelsim::reference {

// Key and random variation of an episode; the spreads add to the sensor's own in quadrature.
struct EpisodeKey {
  std::uint64_t seed = 0;
  std::uint64_t episode = 0;
  double gain = 1;         // factor common to all taxels
  double gain_spread = 0;  // standard deviation of the logarithm of a taxel's gain
  double noise = 0;        // counts, standard deviation
};

class Imperfections {
 public:
  Imperfections(const Readout& readout, std::size_t num_taxels, const EpisodeKey& key);

  // Advances the random walk by dt (s, > 0).
  void step(double dt);

  // Draw for frame number `frame` since the reset.
  ReadoutDraw draw(std::uint32_t frame) const;

 private:
  Readout readout_;
  EpisodeKey key_;
  std::uint32_t num_steps_ = 0;
  std::vector<double> walk_;  // (num_taxels), counts
};

}  // namespace taxelsim::reference
