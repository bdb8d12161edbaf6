// Judges the episodes of a slice by a task, frame by frame.
#pragma once

#include <cstdint>
#include <vector>

#include "episodes/episode_sink.h"
#include "episodes/slice.h"
#include "taxelsim/verdict.h"

namespace taxelsim {

class TaskEvaluator : public EpisodeSink {
 public:
  // The slices of a batch share `next` and `verdicts` (num_episodes); all must outlive this.
  TaskEvaluator(const EpisodePlan& plan, std::uint64_t& next, std::vector<Verdict>& verdicts, int num_instances);

  std::optional<std::uint64_t> next(int instance) override;
  void begin(int instance, const EpisodeRecord& record) override;
  void frame(const FrameView& view, const FrameContext& context) override;
  void end(int instance) override;

 private:
  using Errors = std::array<double, kNumTaskMeasures>;

  struct Slot {
    Verdict verdict;
    double start_force = 0;
    int frame = 0;
    double within_since = 0;  // s; NaN while an error is out of its tolerance
    bool touching = false;
    Vector3 origin{};                                       // of S in O, of the frame before
    double arc = 0;                                         // m, of the frame before; NaN at first
    double progress = 0;                                    // m along the contour, less where it goes back
    std::array<std::vector<float>, kNumTaskMeasures> held;  // errors of the last frames, (frames that the task holds)
  };

  Errors errorsOf(const FrameView& view, std::size_t row, const ProjectedEdge& edge, const Slot& slot) const;
  void look(const FrameView& view, const FrameContext& context, std::size_t i);

  const EpisodePlan& plan_;
  const Task& task_;
  std::uint64_t& next_;
  std::vector<Verdict>& verdicts_;
  bool needs_edge_;
  int num_held_;             // frames
  Vector3 middle_;           // of the array
  std::vector<Slot> slots_;  // (num_instances)
};

}  // namespace taxelsim
