// Readout of three-axis taxels in the reference: forces after the spread -> signed counts along x, y and the normal.
// include/taxelsim/three_axis_readout.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "reference/imperfections.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// The electronics of one sensor instance. The hysteresis starts unloaded.
class ThreeAxis {
 public:
  // `key`: of the instance; its noise does not act here. Keeps a reference to `sensor`, whose readout has three_axis.
  ThreeAxis(const Sensor& sensor, const EpisodeKey& key);

  // Counts of a frame, (num_taxels x 3), after a step with these forces (N): shear along x and y, normal, of each taxel. Halves round up.
  std::vector<std::int32_t> step(std::span<const Vector3> force, std::uint32_t frame);

 private:
  const Sensor& sensor_;
  EpisodeKey key_;
  std::vector<Vector3> play_;  // (num_taxels), N
};

}  // namespace taxelsim::reference
