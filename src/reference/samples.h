// Where the reference looks at the skin: s x s samples per taxel, at the cell centres of a sub-grid of the taxel.
//
// Arrays over samples are ordered [taxel][a][b], a along x and b along y of the patch; sample (a, b) of a taxel lies at
//   ((a + 1/2) / s - 1/2) pitch_x, ((b + 1/2) / s - 1/2) pitch_y   from the taxel's centre, in the plane z = 0 of P.
#pragma once

#include <cstddef>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// One sample on the undeformed skin.
struct Sample {
  int patch = 0;
  int taxel = 0;
  Vector3 position_P{0, 0, 0};  // m
  double area = 0;              // m^2: pitch_x pitch_y / s^2
};

// All samples of the sensor, (num_taxels x s x s).
std::vector<Sample> samplesOf(const Sensor& sensor);

// Samples of one taxel: s^2.
inline std::size_t samplesPerTaxel(const Sensor& sensor) {
  return static_cast<std::size_t>(sensor.samples_per_taxel) * static_cast<std::size_t>(sensor.samples_per_taxel);
}

}  // namespace taxelsim::reference
