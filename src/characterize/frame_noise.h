// Noise of a reading from frame to frame, and its drift, in recordings under a constant load.
#pragma once

#include <cstddef>
#include <span>

namespace taxelsim {

struct Stamp;

// Means over the taxels of all recordings, whose scatter gives the half widths of the 95 % intervals.
struct FrameNoise {
  double variance = 0;       // counts^2, of white noise without the rounding to counts
  double variance_half = 0;  // infinite for fewer than two series
  double walk = 0;           // counts^2 / s, growth of the variance of an offset that drifts
  double walk_half = 0;
  std::size_t num_series = 0;  // taxels of all recordings
};

// Uses the frames from 3 s after contact on, where creep is slow, of taxels that never read 0 or `top`. Second differences over k frames
// remove a straight trend; their variance is 6 x variance + 2 walk k dt.
FrameNoise frameNoiseOf(std::span<const Stamp> stamps, double top);

}  // namespace taxelsim
