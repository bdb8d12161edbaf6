// Evaluates the episodes of a slice against the task of the scene, on ground truth, and stores a Verdict per episode.
//
// Per frame it computes the error of each criterion of the task. An episode succeeds if all errors stay within their tolerances during the
// last Task::hold seconds, and the required laps and travel were reached (include/taxelsim/task.h).
#pragma once

#include <cstdint>
#include <vector>

#include "episodes/episode_sink.h"
#include "episodes/slice.h"
#include "taxelsim/verdict.h"

namespace taxelsim {

class TaskEvaluator : public EpisodeSink {
 public:
  // The slices of a batch share `next`, the number of the next episode, and `verdicts` (num_episodes). All references must outlive this.
  TaskEvaluator(const EpisodePlan& plan, std::uint64_t& next, std::vector<Verdict>& verdicts, int num_instances);

  std::optional<std::uint64_t> next(int instance) override;
  void begin(int instance, const EpisodeRecord& record) override;
  void frame(const FrameView& view, const FrameContext& context) override;
  void end(int instance) override;

 private:
  using Errors = std::array<double, kNumTaskMeasures>;

  // State of the episode that an instance runs.
  struct EpisodeState {
    Verdict verdict;
    double start_force = 0;  // N
    int frame = 0;
    double within_since = 0;  // s; NaN while an error exceeds its tolerance
    bool touching = false;
    Vector3 origin{};                                               // m, origin of S in O in the preceding frame
    double arc = 0;                                                 // m, contour position in the preceding frame; NaN before the first
    double progress = 0;                                            // m, signed progress along the contour
    std::array<std::vector<float>, kNumTaskMeasures> final_errors;  // (num_hold_frames_)
  };

  Errors errorsOf(const FrameView& view, std::size_t row, const ProjectedEdge& edge, const EpisodeState& state) const;
  void evaluateFrame(const FrameView& view, const FrameContext& context, std::size_t i);

  const EpisodePlan& plan_;
  const Task& task_;
  std::uint64_t& next_;
  std::vector<Verdict>& verdicts_;
  bool needs_edge_;
  int num_hold_frames_;  // frames at the end of an episode that count for its success
  Vector3 array_middle_;
  std::vector<EpisodeState> states_;  // (num_instances)
};

}  // namespace taxelsim
