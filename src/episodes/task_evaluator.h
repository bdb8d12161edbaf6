// Evaluates the episodes of a slice against the task of the scene, and stores a Verdict per episode.
#pragma once

#include <cstdint>
#include <vector>

#include "episodes/episode_sink.h"
#include "episodes/task_judge.h"

namespace taxelsim {

class TaskEvaluator : public EpisodeSink {
 public:
  // The slices of a batch share `verdicts` (num_episodes), which are of the episodes from `first_episode` on, and `next`, the index of the
  // next one. All references must outlive this.
  TaskEvaluator(const EpisodePlan& plan, std::uint64_t first_episode, std::uint64_t& next, std::vector<Verdict>& verdicts,
                int num_instances)
      : judge_(plan, num_instances), first_episode_(first_episode), next_(next), verdicts_(verdicts) {}

  std::optional<std::uint64_t> next(int instance) override;
  void begin(int instance, const EpisodeRecord& record) override { judge_.begin(instance, record); }
  void frame(const FrameView& view, const FrameContext& context) override { judge_.frame(view, context); }
  void end(int instance) override;

 private:
  TaskJudge judge_;
  std::uint64_t first_episode_;
  std::uint64_t& next_;
  std::vector<Verdict>& verdicts_;
};

}  // namespace taxelsim
