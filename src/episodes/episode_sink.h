// Consumer of the frames of a slice: writes a data set, evaluates a task, or records a trace.
#pragma once

#include <cstdint>
#include <optional>

#include "episodes/frame_context.h"

namespace taxelsim {

// One sink per slice. Called by the thread that runs the slice. Per episode: next(), begin(), frame() for each frame, end().
class EpisodeSink {
 public:
  virtual ~EpisodeSink() = default;

  // Number of the next episode for an idle instance; empty if none are left.
  virtual std::optional<std::uint64_t> next(int instance) = 0;
  // The first frame of the episode is about to be passed to frame().
  virtual void begin(int instance, const EpisodeRecord& record) = 0;
  // One frame of all active instances. `view` is valid during the call.
  virtual void frame(const FrameView& view, const FrameContext& context) = 0;
  // The last frame() was the final one of the instance's episode.
  virtual void end(int instance) = 0;
};

}  // namespace taxelsim
