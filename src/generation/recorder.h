// Copies the frames of a slice into the columns of shards: each value directly to its final place, without allocation.
#pragma once

#include <cstdint>
#include <span>

#include "episodes/episode_sink.h"
#include "episodes/true_edge.h"
#include "generation/columns.h"
#include "generation/shard_queue.h"

namespace taxelsim {

// Destination of a frame of one instance.
struct FramePlace {
  std::byte* const* columns = nullptr;  // ShardBuffer::columns; null if the instance is idle
  std::uint64_t row = 0;                // frame row in the shard
  std::size_t object = 0;               // index of the episode's object in the scene
};

// Thread-safe for disjoint places: stateless after construction.
class Recorder {
 public:
  // edges (num_objects): must outlive this.
  Recorder(const ColumnPlan& plan, std::span<const TrueEdge> edges) : plan_(plan), edges_(edges) {}

  // Frame of all instances; places (num_instances).
  void recordFrames(const FrameView& frame, const FrameContext& context, std::span<const FramePlace> places) const;
  void recordEpisode(const EpisodeValues& values, const EpisodePlace& place) const;

 private:
  void recordExactEdge(const FrameContext& context, std::span<const FramePlace> places, std::size_t angle_column) const;

  ColumnPlan plan_;
  std::span<const TrueEdge> edges_;
};

}  // namespace taxelsim
