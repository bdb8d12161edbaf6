// Counts that a sensor reported, back in newtons: the stages of sensor.h undone in reverse, readout, creep, point spread function. Part of
// the library taxelsim_characterize. Hysteresis, low-pass, delay and imperfections that are drawn stay in.
#pragma once

#include <cstddef>
#include <vector>

#include "taxelsim/measurement.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

struct ReadingsOptions {
  // The exact inverse of Readout::creep, each force held from the row before to its own, the first one having begun at its row. A force
  // that comes out below 0, where a trigger hid what the creep still showed, is 0. An error there fades like the creep itself: the inverse
  // has its poles between 0 and exp(-dt / time) of the slowest term.
  bool remove_creep = false;
  // The forces F >= 0 whose spread G F is nearest to the image, in the sense of least squares, row by row.
  bool remove_spread = false;
};

struct Readings {
  std::vector<double> force;      // (rows x num_taxels), N
  std::vector<int> dead_taxels;   // with a gain of 0, indices in storage order: their forces are 0 before the spread is undone
  std::size_t num_saturated = 0;  // readings at saturation or above: their force is the one there, and may have been more
};

// Force (N) on each taxel that reads images.counts without noise: 0 for 0 counts, else (root of the curve + trigger) / gain of the taxel.
// Throws Error(kInput) when images and sensor differ in their number of taxels, creep is to be removed without times, or the point spread
// function has no inverse.
Readings readingsInNewtons(const Sensor& sensor, const Images& images, const ReadingsOptions& options = {});

}  // namespace taxelsim
