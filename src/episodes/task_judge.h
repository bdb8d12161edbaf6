// Judges the episodes of a batch against the task of the scene, on ground truth.
//
// Per frame it computes the error of each criterion of the task. An episode succeeds if all errors stay within their tolerances during the
// last Task::hold seconds, and the required laps and travel were reached (include/taxelsim/task.h).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "episodes/frame_context.h"
#include "episodes/plan.h"
#include "simulation/servo_loop.h"
#include "taxelsim/verdict.h"

namespace taxelsim {

class TaskJudge {
 public:
  // `plan`, of a scene with a task, must outlive this.
  TaskJudge(const EpisodePlan& plan, int num_instances);

  // What it reads of FrameContext.
  static constexpr LoopOutputs kReads{
      .tactile_image = false, .object_poses = true, .sensor_poses = false, .actions = false, .robot_status = true, .joints = false};

  // An episode starts on an instance; its frame 0 comes next.
  void begin(int instance, const EpisodeRecord& record);
  // Judges the next frame of all instances with context.active[i] != 0; the others keep their state.
  void frame(const FrameView& view, const FrameContext& context);

  // State at the latest judged frame of each instance.
  std::span<const double> errors() const { return errors_; }          // (num_instances x kNumTaskMeasures), SI; see TaskState::errors
  std::span<const std::uint8_t> within() const { return within_; }    // (num_instances), 1: contact, and all errors within tolerance
  std::span<const std::uint8_t> contact() const { return contact_; }  // (num_instances), 1: clean total force > 0
  // (num_instances), of the verdict so far.
  std::span<const float> travel() const { return travel_; }
  std::span<const float> laps() const { return laps_; }
  std::span<const float> peakForce() const { return peak_force_; }
  std::span<const int> numLosses() const { return num_losses_; }

  // Verdict on the frames judged so far. It is a success only after the last frame of the episode.
  Verdict verdict(int instance) const;

 private:
  // State of the episode that an instance runs.
  struct EpisodeState {
    Verdict verdict;
    double start_force = 0;  // N
    int frame = 0;
    double within_since = 0;                                        // s; NaN while an error exceeds its tolerance
    Vector3 origin{};                                               // m, origin of S in O in the preceding frame
    double arc = 0;                                                 // m, contour position in the preceding frame; NaN before the first
    double progress = 0;                                            // m, signed progress along the contour
    std::array<std::vector<float>, kNumTaskMeasures> final_errors;  // (num_hold_frames_)
  };

  float lapsOf(const EpisodeState& state) const;
  void updateMotion(EpisodeState& state, const Pose& X_SO, double arc) const;
  void updateErrors(std::size_t i, const FrameView& view, std::size_t row, const ProjectedEdge& edge);
  void judgeFrame(const FrameView& view, const FrameContext& context, std::size_t i);

  const EpisodePlan& plan_;
  const Task& task_;
  bool needs_edge_;
  int num_hold_frames_;  // frames at the end of an episode that count for its success
  Vector3 array_middle_;

  // (num_instances)
  std::vector<EpisodeState> states_;
  std::vector<double> errors_;  // x kNumTaskMeasures
  std::vector<std::uint8_t> within_;
  std::vector<std::uint8_t> contact_;
  std::vector<float> travel_, laps_, peak_force_;
  std::vector<int> num_losses_;
};

}  // namespace taxelsim
