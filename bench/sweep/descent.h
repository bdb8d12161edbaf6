// Coordinate descent over settings: tries all values of one axis, keeps the fastest, continues with the next axis. Does not find gains that
// need two changes at once.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "sweep/setting.h"

namespace taxelsim::bench {

// Medians, s per frame of the batch.
struct FrameTime {
  double contact = 0, image = 0, device = 0;  // by the device's clock; NaN without one
  double wall = 0;                            // from step() to the end of read()
};

// Objective for an axis of this pass: the time of the pass; the wall clock if the device has no clock.
double secondsOf(const FrameTime& time, Pass pass);

// Times a setting; empty if the device refuses it. Called once per setting.
using Measure = std::function<std::optional<FrameTime>(const Setting&)>;

struct Descent {
  int rounds = 2;                      // over all axes; stops early after a round without a change
  double least_gain = 0.01;            // smallest relative gain that counts: timings scatter
  std::vector<std::size_t> over;       // axes
  std::vector<std::vector<int>> only;  // (kNumAxes): values to try; empty: all of the axis
};

// Returns the fastest setting found from `start`, whose time is `start_time`.
Setting descend(const Setting& start, const FrameTime& start_time, const Descent& how, const Measure& measure);

}  // namespace taxelsim::bench
