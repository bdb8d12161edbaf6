/// @file
/// Electronics of taxels that measure shear as well as normal force.
#pragma once

#include <array>

#include "taxelsim/pose.h"

namespace taxelsim {

inline constexpr int kMaxAxisCounts = (1 << 24) - 1;  ///< ThreeAxisReadout::saturation: float32 holds all counts.

/// Electronics of three-axis taxels, such as magnets over Hall sensors or pillars over photodiodes: force -> signed counts of three axes,
/// per taxel.
///
///     counts[a] = clip(round(g sum_b gain[a][b] h_b(F[b]) + noise[a] n), -saturation, saturation)
///
/// F: the taxel's force after the spread along its x and y (shear on the skin) and into the skin (normal), N. h_b: hysteresis of the axis,
/// (1 - strength) F + strength play(F) with a play operator of half-width `hysteresis_width`, unloaded at a reset. g: Readout::taxel_gain
/// times the gains of the instance, as for the tactile image. n: standard normal, per axis, frame and taxel. Frames come as often as those
/// of the tactile image; its trigger, curve, creep, low-pass and delay do not act here.
struct ThreeAxisReadout {
  /// counts/N: output axis x forces along x, y and the normal. Elements off the diagonal are cross-talk. Each row has one that is not 0.
  std::array<Vector3, 3> gain{};
  Vector3 noise{0, 0, 0};                ///< Counts, >= 0, standard deviation of white Gaussian noise of each axis. Default 0.
  Vector3 hysteresis_strength{0, 0, 0};  ///< 0 to < 1, of each axis of force. Default 0.
  Vector3 hysteresis_width{0, 0, 0};     ///< N, >= 0, of each axis of force. Default 0.
  int saturation = 32767;                ///< Counts, 1 to kMaxAxisCounts: the largest absolute value. Default that of 16 bits.

  bool operator==(const ThreeAxisReadout&) const = default;  ///< Exact comparison.
};

}  // namespace taxelsim
