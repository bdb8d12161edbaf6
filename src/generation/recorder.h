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

// The instances from `first` to before `last`.
struct InstanceRange {
  std::span<const FramePlace> places;  // (num_instances)
  std::size_t first = 0, last = 0;
};

// Thread-safe for disjoint places: stateless after construction.
class Recorder {
 public:
  // edges (num_objects): must outlive this.
  Recorder(const ColumnPlan& plan, std::span<const TrueEdge> edges) : plan_(plan), edges_(edges) {}

  // Frame of all instances; places (num_instances). The threads of context.team share the instances.
  void recordFrames(const FrameView& frame, const FrameContext& context, std::span<const FramePlace> places) const;
  void recordEpisode(const EpisodeValues& values, const EpisodePlace& place) const;

 private:
  void recordRange(const FrameView& frame, const FrameContext& context, const InstanceRange& range) const;
  void recordExactEdge(const FrameContext& context, const InstanceRange& range, std::size_t angle_column) const;

  ColumnPlan plan_;
  std::span<const TrueEdge> edges_;
};

}  // namespace taxelsim
