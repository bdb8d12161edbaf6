// Simulated time of one instance since reset, and when its sensor delivers frames. Only step() advances it.
#pragma once

#include <array>
#include <cstdint>

#include "taxelsim/sensor.h"

namespace taxelsim {

// When frames are due: frame k at k / rate plus a normal deviate of standard deviation `jitter`, the first one at once. Frames keep their
// order. If several are due by the same step, the newest is delivered.
struct FrameTiming {
  double rate = 0;         // Hz; 0: at every step
  double jitter = 0;       // s, at most 1 / rate
  std::uint64_t seed = 0;  // of the jitter
};

struct Clock {
  double time = 0;           // s, of the next step
  double due = 0;            // of the next frame, in periods of the rate
  std::uint32_t frames = 0;  // delivered or skipped so far
  std::uint32_t steps = 0;   // since reset

  // With a tolerance of a billionth of a period.
  bool frameDue(double rate) const { return rate == 0 || time * rate >= due - 1e-9; }
  // Delivers the newest frame that is due and skips the frames between.
  void deliver(const FrameTiming& timing, std::uint64_t episode) {
    if (timing.rate == 0) {
      ++frames;
    } else {
      deliverAt(timing, episode);
    }
  }

 private:
  void deliverAt(const FrameTiming& timing, std::uint64_t episode);
};

// Lengths of the last steps of a simulator, for delays.
class StepHistory {
 public:
  // Adds a step of dt (s).
  void add(double dt);
  // How many steps back the newest one lies that is at least `delay` (s) older than the last, with a tolerance of a billionth of the delay;
  // more than kMaxDelaySteps if there is none.
  std::uint32_t stepsBack(double delay) const;

 private:
  std::array<double, kMaxDelaySteps> lengths_{};  // s, newest first; 0 where there was no step yet
};

}  // namespace taxelsim
