// The first frames of a few episodes. Their bytes differ between machines that compute different values under equal names of device and
// driver: a software renderer compiles for the processor that it runs on, and the host's mathematical functions choose their code by it.
#pragma once

#include "episodes/slice.h"

namespace taxelsim {

inline constexpr int kNumProbeEpisodes = 4;  // different objects and poses
inline constexpr int kNumProbeFrames = 2;    // of each episode: the initial contact and one with the state of a frame before

// Runs kNumProbeEpisodes instances of the plan until sink.isComplete(). Submits and waits. Throws what Simulator throws.
template <typename Sink>
void runProbe(const Model& model, const SlicePlan& plan, Sink& sink) {
  Slice slice(model, plan, kNumProbeEpisodes, sink);
  while (slice.busy() && !sink.isComplete()) {
    slice.submit();
    slice.collect();
  }
}

}  // namespace taxelsim
