#include "generation/shard_sink.h"

#include <memory>
#include <utility>

namespace taxelsim {

ShardSink::ShardSink(const Recorder& recorder, ShardQueue& queue, ShardWriter& writer, int num_frames, int num_instances)
    : recorder_(recorder),
      queue_(queue),
      writer_(writer),
      num_frames_(static_cast<std::uint64_t>(num_frames)),
      episodes_(num_instances),
      frames_(num_instances) {}

std::optional<std::uint64_t> ShardSink::next(int instance) {
  frames_[instance] = {};
  const std::optional<EpisodePlace> place = queue_.next();
  if (!place) return {};
  episodes_[instance] = *place;
  return place->episode;
}

void ShardSink::begin(int instance, const EpisodeRecord& record) {
  const EpisodePlace& place = episodes_[instance];
  recorder_.recordEpisode(record, place);
  frames_[instance] = {place.buffer->columns.data(), place.row * num_frames_};
}

void ShardSink::frame(const FrameView& view, const FrameContext& context) {
  recorder_.recordFrames(view, context, frames_);
  for (FramePlace& place : frames_) ++place.row;
}

void ShardSink::end(int instance) {
  if (std::unique_ptr<ShardBuffer> done = queue_.finish(episodes_[instance])) {
    writer_.submit(std::move(done));
    queue_.recycle(writer_.reclaim());
  }
}

}  // namespace taxelsim
