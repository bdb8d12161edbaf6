#include "simulation/clock.h"

#include <algorithm>
#include <cmath>

#include "base/philox.h"

namespace taxelsim {

void Clock::deliverAt(const FrameTiming& timing, std::uint64_t episode) {
  const double now = time * timing.rate + 1e-9;
  const double spread = timing.jitter * timing.rate;
  const auto due_of = [&](std::uint32_t frame) {
    if (spread == 0) return static_cast<double>(frame);
    return frame + spread * gaussian({.seed = timing.seed, .episode = episode, .frame = frame, .purpose = Purpose::kJitter});
  };
  // Skips the frames that are due whatever their jitter, then tests one by one.
  const double certain = std::floor(now - spread * kMaxGaussian) + 1;
  frames = std::max(frames + 1, static_cast<std::uint32_t>(std::max(certain, 0.0)));
  for (due = due_of(frames); due <= now; due = due_of(frames)) ++frames;
}

void StepHistory::add(double dt) {
  std::rotate(lengths_.begin(), lengths_.end() - 1, lengths_.end());
  lengths_.front() = dt;
}

std::uint32_t StepHistory::stepsBack(double delay) const {
  std::uint32_t back = 0;
  double age = 0;
  while (age < delay * (1 - 1e-9) && back <= kMaxDelaySteps) {
    if (back < kMaxDelaySteps) age += lengths_[back];
    ++back;
  }
  return back;
}

}  // namespace taxelsim
