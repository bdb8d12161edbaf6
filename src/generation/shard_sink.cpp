#include "generation/shard_sink.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace taxelsim {
namespace {

constexpr int kNone = -1;

}  // namespace

ShardSink::ShardSink(const EpisodePlan& plan, const Recorder& recorder, ShardQueue& queue, ShardWriter& writer,
                     std::vector<LoadMisses>& load_misses, ContactMissCounter& contact_misses, int num_instances)
    : recorder_(recorder),
      queue_(queue),
      writer_(writer),
      load_misses_(load_misses),
      contact_misses_(contact_misses),
      num_frames_(static_cast<std::uint64_t>(plan.num_frames)),
      episodes_(num_instances),
      records_(num_instances),
      frames_(num_instances),
      touched_(num_instances, 0),
      missed_objects_(num_instances, kNone) {
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
  touched_[instance] = record.load_reached == 0;
  if (judge_) judge_->begin(instance, record);
  if (record.object == kNoObject) return;
  ++load_misses_[static_cast<std::size_t>(record.object)].num_episodes;
  if (record.load_reached == 0) missed_objects_[instance] = record.object;
}

// The first frame of such an episode has the largest force that the skin can exert on the object.
void ShardSink::countLoadMisses(const FrameView& view, const FrameContext& context) {
  for (std::size_t i = 0; i < missed_objects_.size(); ++i) {
    const int object = std::exchange(missed_objects_[i], kNone);
    if (object == kNone) continue;
    LoadMisses& misses = load_misses_[static_cast<std::size_t>(object)];
    const float carried = view.ground_truth.total_force[i * static_cast<std::size_t>(context.num_sensors)];
    misses.carried = {misses.num_misses == 0 ? carried : std::min(misses.carried[0], carried), std::max(misses.carried[1], carried)};
    ++misses.num_misses;
  }
}

void ShardSink::noteContacts(const FrameView& view, const FrameContext& context) {
  const auto num_sensors = static_cast<std::size_t>(context.num_sensors);
  for (std::size_t row = 0; row < touched_.size() * num_sensors; ++row)
    touched_[row / num_sensors] |= view.ground_truth.total_force[row] > 0;
}

void ShardSink::frame(const FrameView& view, const FrameContext& context) {
  countLoadMisses(view, context);
  noteContacts(view, context);
  recorder_.recordFrames(view, context, frames_);
  if (judge_) judge_->frame(view, context);
  for (FramePlace& place : frames_) ++place.row;
}

void ShardSink::end(int instance) {
  contact_misses_.add(records_[instance].episode, touched_[instance] != 0);
  recorder_.recordEpisode({.record = records_[instance], .success = judge_ && judge_->verdict(instance).success}, episodes_[instance]);
  if (std::unique_ptr<ShardBuffer> done = queue_.finish(episodes_[instance])) {
    writer_.submit(std::move(done));
    queue_.recycle(writer_.reclaim());
  }
}

}  // namespace taxelsim
