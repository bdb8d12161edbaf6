#include "generation/shard_sink.h"

#include <memory>
#include <utility>

namespace taxelsim {

ShardSink::ShardSink(const EpisodePlan& plan, const Recorder& recorder, ShardQueue& queue, ShardWriter& writer, int num_instances)
    : recorder_(recorder),
      queue_(queue),
      writer_(writer),
      num_frames_(static_cast<std::uint64_t>(plan.num_frames)),
      episodes_(num_instances),
      records_(num_instances),
      frames_(num_instances) {
  if (plan.scene.task) judge_.emplace(plan, num_instances);
}

std::optional<std::uint64_t> ShardSink::next(int instance) {
  frames_[instance] = {};
  const std::optional<EpisodePlace> place = queue_.next();
  if (!place) return {};
  episodes_[instance] = *place;
  return place->episode;
}

void ShardSink::begin(int instance, const EpisodeRecord& record) {
  const EpisodePlace& place = episodes_[instance];
  records_[instance] = record;
  frames_[instance] = {place.buffer->columns.data(), place.row * num_frames_, static_cast<std::size_t>(record.object)};
  if (judge_) judge_->begin(instance, record);
}

void ShardSink::frame(const FrameView& view, const FrameContext& context) {
  recorder_.recordFrames(view, context, frames_);
  if (judge_) judge_->frame(view, context);
  for (FramePlace& place : frames_) ++place.row;
}

void ShardSink::end(int instance) {
  recorder_.recordEpisode({.record = records_[instance], .success = judge_ && judge_->verdict(instance).success}, episodes_[instance]);
  if (std::unique_ptr<ShardBuffer> done = queue_.finish(episodes_[instance])) {
    writer_.submit(std::move(done));
    queue_.recycle(writer_.reclaim());
  }
}

}  // namespace taxelsim
