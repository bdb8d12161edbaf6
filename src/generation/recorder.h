// Copies one frame of a slice into the shards' columns: every value straight to its final place, without allocation.
#pragma once

#include <cstdint>
#include <span>

#include "episodes/episode_sink.h"
#include "generation/columns.h"
#include "generation/shard_queue.h"

namespace taxelsim {

// Where the frame of one instance goes.
struct FramePlace {
  std::byte* const* columns = nullptr;  // of its shard; null when the instance is idle
  std::uint64_t row = 0;                // of the frame in its shard
};

class Recorder {
 public:
  explicit Recorder(const ColumnPlan& plan) : plan_(plan) {}

  // `places` (N).
  void recordFrames(const FrameView& frame, const FrameContext& context, std::span<const FramePlace> places) const;
  void recordEpisode(const EpisodeRecord& record, const EpisodePlace& place) const;

 private:
  ColumnPlan plan_;
};

}  // namespace taxelsim
