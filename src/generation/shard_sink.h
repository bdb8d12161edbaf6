// Frames of a slice on their way into the shards of a data set.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "episodes/episode_sink.h"
#include "generation/recorder.h"
#include "generation/shard_queue.h"
#include "generation/shard_writer.h"

namespace taxelsim {

class ShardSink : public EpisodeSink {
 public:
  // All must outlive this; `queue` is of one thread. num_frames: of an episode.
  ShardSink(const Recorder& recorder, ShardQueue& queue, ShardWriter& writer, int num_frames, int num_instances);

  std::optional<std::uint64_t> next(int instance) override;
  void begin(int instance, const EpisodeRecord& record) override;
  void frame(const FrameView& view, const FrameContext& context) override;
  // Hands a shard that is complete to the writer.
  void end(int instance) override;

 private:
  const Recorder& recorder_;
  ShardQueue& queue_;
  ShardWriter& writer_;
  std::uint64_t num_frames_;

  // (num_instances) each.
  std::vector<EpisodePlace> episodes_;
  std::vector<FramePlace> frames_;
};

}  // namespace taxelsim
