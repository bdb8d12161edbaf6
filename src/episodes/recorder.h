// Copies one frame of a slice into the shards' columns: every value straight to its final place, without allocation.
#pragma once

#include <cstdint>
#include <span>

#include "control/robots.h"
#include "episodes/columns.h"
#include "episodes/shard_queue.h"

namespace taxelsim {

// Where the frame of one instance goes.
struct FramePlace {
  std::byte* const* columns = nullptr;  // of its shard; null when the instance is idle
  std::uint64_t row = 0;                // of the frame in its shard
};

// What a frame holds beside the simulator's outputs; all (N).
struct FrameContext {
  std::span<const FramePlace> places;
  std::span<const double> times;  // s
  std::span<const Pose> X_SO;
  std::span<const Twist> twists;  // of the sensor frame
  const Robots* robots;           // with one sensor each
};

class Recorder {
 public:
  explicit Recorder(const ColumnPlan& plan) : plan_(plan) {}

  void recordFrames(const FrameView& frame, const FrameContext& context) const;
  void recordEpisode(const EpisodeRecord& record, const EpisodePlace& place) const;

 private:
  ColumnPlan plan_;
};

}  // namespace taxelsim
