#include "episodes/grasp_judge.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace taxelsim {

std::vector<GraspJudge::Touch> touchesOf(const GraspBatch& batch, const Grasp& grasp, int instance) {
  std::vector<GraspJudge::Touch> touches;
  for (const GraspFinger& finger : grasp.fingers) {
    const GroundTruthView& truth = batch.robots().frame(finger.sensor).ground_truth;
    const std::size_t row = batch.robots().row(finger.sensor, instance);
    touches.push_back(
        {.force = truth.total_force[row], .center = {truth.center_of_pressure[3 * row], truth.center_of_pressure[3 * row + 1]}});
  }
  return touches;
}

GraspJudge::GraspJudge(const GraspTask& task, int num_frames, double dt, std::uint64_t episode, std::span<const double> targets)
    : task_(task),
      first_held_(num_frames - std::clamp(static_cast<int>(std::lround(task.hold / dt)), 1, num_frames)),
      num_frames_(num_frames),
      dt_(dt),
      verdict_{.episode = episode, .success = false, .fingers = {}},
      states_(targets.size(), {.within_since = kNaN}),
      touched_(targets.size()) {
  for (const double target : targets) verdict_.fingers.push_back({.target = target, .settling_time = kNaN});
}

void GraspJudge::frame(std::span<const Touch> touches) {
  for (std::size_t f = 0; f < touches.size(); ++f) {
    judge(verdict_.fingers[f], states_[f], touches[f]);
    const bool touches_now = touches[f].force > 0;
    if (touched_[f] != 0 && !touches_now) ++verdict_.fingers[f].num_losses;
    touched_[f] = touches_now;
  }
  ++frame_;
}

void GraspJudge::judge(FingerVerdict& finger, State& state, const Touch& touch) {
  const double error = touch.force - finger.target;
  finger.peak_force = std::max(finger.peak_force, touch.force);
  if (!(std::abs(error) <= task_.tolerance * finger.target)) {
    state.within_since = kNaN;
  } else if (std::isnan(state.within_since)) {
    state.within_since = frame_ * dt_;
  }
  if (frame_ < first_held_) return;
  state.square_sum += error * error;
  if (frame_ == first_held_) state.first_center = touch.center;
  const double distance = std::hypot(touch.center[0] - state.first_center[0], touch.center[1] - state.first_center[1]);
  finger.drift = touch.force > 0 && !std::isnan(finger.drift) ? std::max(finger.drift, distance) : kNaN;
}

GraspVerdict GraspJudge::verdict() const {
  GraspVerdict verdict = verdict_;
  verdict.success = true;
  for (std::size_t f = 0; f < verdict.fingers.size(); ++f) {
    FingerVerdict& finger = verdict.fingers[f];
    finger.settling_time = states_[f].within_since;
    finger.force_error = std::sqrt(states_[f].square_sum / (num_frames_ - first_held_));
    // A force that is within its tolerance since a frame before the end began, or with it.
    finger.held = finger.settling_time <= first_held_ * dt_ && (!task_.drift || finger.drift <= *task_.drift);
    verdict.success = verdict.success && finger.held;
  }
  return verdict;
}

}  // namespace taxelsim
