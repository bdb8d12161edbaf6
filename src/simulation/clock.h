// Time of one instance since reset, and when its sensor delivers frames. Not the clock of a process: only step() moves it.
#pragma once

#include <array>
#include <cstdint>

#include "taxelsim/sensor.h"

namespace taxelsim {

// When frames are due: frame k at k / rate, moved by a normal number of standard deviation `jitter`; the first one at once. Frames keep
// their order, and of several that have become due by the same step the newest is delivered.
struct FrameTiming {
  double rate = 0;         // Hz; 0: at every step
  double jitter = 0;       // s, at most 1 / rate
  std::uint64_t seed = 0;  // of the jitter
};

struct Clock {
  double time = 0;           // s, of the next step
  double due = 0;            // of the next frame, in periods of the rate
  std::uint32_t frames = 0;  // delivered or passed over so far
  std::uint32_t steps = 0;   // since reset

  // A step that comes within a billionth of a period is in time.
  bool frameDue(double rate) const { return rate == 0 || time * rate >= due - 1e-9; }
  // Passes over frames that fell between two steps.
  void deliver(const FrameTiming& timing, std::uint64_t episode);
};

// The lengths of the last steps of a simulator: how far back a delay reaches.
class StepHistory {
 public:
  // Of the steps with another one of dt (s) after them: how many lie between that one and the newest that is at least `delay` (s) older.
  // More than kMaxDelaySteps where there is none. A step that is too young by a billionth of the delay is old enough.
  std::uint32_t stepsBack(double dt, double delay);

 private:
  std::array<double, kMaxDelaySteps> lengths_{};  // s, newest first; 0 where there was no step yet
};

}  // namespace taxelsim
