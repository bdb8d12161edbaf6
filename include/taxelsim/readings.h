/// @file
/// Converts recorded counts back to newtons: inverts the readout, the creep and the point spread function of sensor.h, in this order.
/// Hysteresis, low-pass, delay and random imperfections are not inverted.
#pragma once

#include <cstddef>
#include <vector>

#include "taxelsim/measurement.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

/// Options of readingsInNewtons().
struct ReadingsOptions {
  /// Inverts Readout::creep exactly. Each force is assumed constant from the previous row to its own; the first force starts at its row. A
  /// negative result, where the trigger hid a creep that was still decaying, is set to 0. An error decays like the creep itself: the poles
  /// of the inverse lie between 0 and exp(-dt / time) of the slowest term. Default false.
  bool remove_creep = false;
  /// Inverts the point spread function row by row: non-negative least squares of G F against the image. Default false.
  bool remove_spread = false;
};

/// Result of readingsInNewtons().
struct Readings {
  std::vector<double> force;      ///< (rows x num_taxels), N.
  std::vector<int> dead_taxels;   ///< Taxels with gain 0, in storage order; their force is 0 before the spread is inverted.
  std::size_t num_saturated = 0;  ///< Readings at saturation; their force is the one at saturation, a lower bound.
};

/// Force (N) on each taxel that produces `images.counts` without noise.
///
/// 0 for 0 counts, else (root of the curve + trigger) / gain of the taxel. Throws Error(kInput) if images and sensor differ in their number
/// of taxels, if creep is to be removed from images without times, or if the point spread function is singular.
Readings readingsInNewtons(const Sensor& sensor, const Images& images, const ReadingsOptions& options = {});

}  // namespace taxelsim
