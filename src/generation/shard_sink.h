// Episode sink that records the frames of a slice into the shards of a data set.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "episodes/contact_misses.h"
#include "episodes/episode_sink.h"
#include "episodes/task_judge.h"
#include "generation/recorder.h"
#include "generation/shard_queue.h"
#include "generation/shard_writer.h"
#include "taxelsim/generate.h"

namespace taxelsim {

class ShardSink : public EpisodeSink {
 public:
  // All references must outlive this. The sinks of all slices share the queue, load_misses (num_objects) and contact_misses, and must be
  // used by one thread.
  ShardSink(const EpisodePlan& plan, const Recorder& recorder, ShardQueue& queue, ShardWriter& writer, std::vector<LoadMisses>& load_misses,
            ContactMissCounter& contact_misses, int num_instances);

  std::optional<std::uint64_t> next(int instance) override;
  void begin(int instance, const EpisodeRecord& record) override;
  void frame(const FrameView& view, const FrameContext& context) override;
  // Submits a complete shard to the writer.
  void end(int instance) override;

 private:
  void countLoadMisses(const FrameView& view, const FrameContext& context);
  void noteContacts(const FrameView& view, const FrameContext& context);

  const Recorder& recorder_;
  ShardQueue& queue_;
  ShardWriter& writer_;
  std::vector<LoadMisses>& load_misses_;
  ContactMissCounter& contact_misses_;
  std::uint64_t num_frames_;        // per episode
  std::optional<TaskJudge> judge_;  // of scenes with a task

  // (num_instances)
  std::vector<EpisodePlace> episodes_;
  std::vector<EpisodeRecord> records_;
  std::vector<FramePlace> frames_;
  std::vector<std::uint8_t> touched_;  // 1: some sensor has had contact in the episode, or its load is out of reach
  std::vector<int> missed_objects_;    // object of an instance in the first frame of an episode whose load is out of reach, else -1
};

}  // namespace taxelsim
