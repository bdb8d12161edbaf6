// What stage 5 draws for one instance in one episode: the device's own random numbers, in double precision. Keeps the random walk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reference/readout.h"

namespace taxelsim::reference {

// Of one episode; what a scene adds to the sensor's own.
struct EpisodeKey {
  std::uint64_t seed = 0;
  std::uint64_t episode = 0;
  double gain = 1;
  double gain_spread = 0;
  double noise = 0;  // counts
};

class Imperfections {
 public:
  Imperfections(const Readout& readout, std::size_t num_taxels, const EpisodeKey& key);

  // Advances the random walk by dt (s, > 0).
  void step(double dt);

  // What frame number `frame` since reset is read with.
  ReadoutDraw draw(std::uint32_t frame) const;

 private:
  Readout readout_;
  EpisodeKey key_;
  std::uint32_t num_steps_ = 0;
  std::vector<double> walk_;  // (num_taxels), counts
};

}  // namespace taxelsim::reference
