// Copies the frames of a slice into the columns of shards: each value directly to its final place, without allocation.
#pragma once

#include <cstdint>
#include <span>

#include "episodes/episode_sink.h"
#include "generation/columns.h"
#include "generation/shard_queue.h"

namespace taxelsim {

// Destination of a frame of one instance.
struct FramePlace {
  std::byte* const* columns = nullptr;  // ShardBuffer::columns; null if the instance is idle
  std::uint64_t row = 0;                // frame row in the shard
};

// Thread-safe for disjoint places: stateless after construction.
class Recorder {
 public:
  explicit Recorder(const ColumnPlan& plan) : plan_(plan) {}

  // Frame of all instances; places (num_instances).
  void recordFrames(const FrameView& frame, const FrameContext& context, std::span<const FramePlace> places) const;
  // Constants of an episode.
  void recordEpisode(const EpisodeRecord& record, const EpisodePlace& place) const;

 private:
  ColumnPlan plan_;
};

}  // namespace taxelsim
