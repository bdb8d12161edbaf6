// Sample points of the skin: the quadrature points of all contact laws. The reference computes depth and pressure at s x s points per
// taxel, s = Sensor::samples_per_taxel, and a taxel's force is the midpoint-rule sum of pressure times cell area.
//
//   y ^  +-----------------+
//     |  |  o   o   o   o  |   One taxel, pitch_x by pitch_y, s = 4. Sample (a, b), marked o, is the centre of a cell of
//     |  |  o   o   o   o  |   pitch_x / s by pitch_y / s. Relative to the taxel's centre it lies at
//     |  |  o   o   o   o  |     x = ((a + 1/2) / s - 1/2) pitch_x,
//     |  |  o   o   o   o  |     y = ((b + 1/2) / s - 1/2) pitch_y,
//     |  +-----------------+   in the plane z = 0 of the patch frame P; z points out of the skin.
//     +----------------------> x
//
// Arrays over samples have shape (num_taxels x s x s), ordered [taxel][a][b] with a along x and b along y.
#pragma once

#include <cstddef>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// A sample on the undeformed skin.
struct Sample {
  int patch = 0;
  int taxel = 0;                // index in the sensor; kNoTaxel (friction.h) in the margin of an elastic layer
  Vector3 position_P{0, 0, 0};  // m
  double area = 0;              // m^2, of its cell: pitch_x pitch_y / s^2
};

// All samples of the sensor, (num_taxels x s x s).
std::vector<Sample> samplesOf(const Sensor& sensor);

// s^2.
inline std::size_t samplesPerTaxel(const Sensor& sensor) {
  return static_cast<std::size_t>(sensor.samples_per_taxel) * static_cast<std::size_t>(sensor.samples_per_taxel);
}

}  // namespace taxelsim::reference
