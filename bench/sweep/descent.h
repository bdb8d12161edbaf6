// Coordinate descent over settings: one axis at a time, all its values, the fastest stays; then the next axis from there. Finds what single
// axes can give, not what only a change of two at once would.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "sweep/setting.h"

namespace taxelsim::bench {

// Seconds of a frame, medians.
struct FrameTime {
  double contact = 0, image = 0, device = 0;  // by the device's clock; NaN where it has none
  double wall = 0;                            // from step() to the frame in hand
};

// What an axis of this pass is judged by: the pass's time, the wall clock where the device has no clock.
double secondsOf(const FrameTime& time, Pass pass);

// Times a setting; nothing where the device refuses it. Never called twice with the same.
using Measure = std::function<std::optional<FrameTime>(const Setting&)>;

struct Descent {
  int rounds = 2;                      // over all axes; ends early where one changes nothing
  double least_gain = 0.01;            // by less a setting is not better: timings scatter
  std::vector<std::size_t> over;       // axes
  std::vector<std::vector<int>> only;  // (kNumAxes): values to try instead of all of the axis; empty: all
};

// From `start`, which has taken `start_time`, to the fastest setting found.
Setting descend(const Setting& start, const FrameTime& start_time, const Descent& how, const Measure& measure);

}  // namespace taxelsim::bench
