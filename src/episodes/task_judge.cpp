#include "episodes/task_judge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/constants.h"
#include "base/vector3.h"

namespace taxelsim {
namespace {

// Upper median; NaN if empty.
float upperMedian(std::vector<float> values) {
  if (values.empty()) return static_cast<float>(kNaN);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

int holdFrames(const EpisodePlan& plan) {
  return std::clamp(static_cast<int>(std::lround(plan.scene.task->hold / plan.dt)), 1, plan.num_frames);
}

}  // namespace

TaskJudge::TaskJudge(const EpisodePlan& plan, int num_instances)
    : plan_(plan),
      task_(*plan.scene.task),
      needs_edge_(task_[TaskMeasure::kEdgeAngle] || task_[TaskMeasure::kContour] || task_.laps > 0),
      num_hold_frames_(holdFrames(plan)),
      array_middle_(arrayMiddle(plan.scene.sensor)),
      states_(num_instances),
      errors_(static_cast<std::size_t>(num_instances) * kNumTaskMeasures, kNaN),
      within_(num_instances, 0),
      contact_(num_instances, 0),
      travel_(num_instances, 0.0f),
      laps_(num_instances, 0.0f),
      peak_force_(num_instances, 0.0f),
      num_losses_(num_instances, 0) {
  for (EpisodeState& state : states_) {
    for (std::size_t m = 0; m < kNumTaskMeasures; ++m) {
      if (task_.criteria[m]) state.final_errors[m].reserve(static_cast<std::size_t>(num_hold_frames_));
    }
  }
}

void TaskJudge::begin(int instance, const EpisodeRecord& record) {
  EpisodeState& state = states_[instance];
  state.verdict = {.episode = record.episode, .object = record.object, .load_reached = record.load_reached != 0};
  state.start_force = record.start_force;
  state.frame = 0;
  state.within_since = kNaN;
  state.arc = kNaN;
  state.progress = 0;
  for (std::vector<float>& errors : state.final_errors) errors.clear();
  contact_[instance] = 0;
}

// Infinite where the error is undefined, NaN for measures without a criterion.
void TaskJudge::updateErrors(std::size_t i, const FrameView& view, std::size_t row, const ProjectedEdge& edge) {
  const std::span<double> errors = std::span(errors_).subspan(i * kNumTaskMeasures, kNumTaskMeasures);
  std::fill(errors.begin(), errors.end(), kNaN);
  const auto set = [&](TaskMeasure measure, double error) {
    if (!task_[measure]) return;
    errors[static_cast<std::size_t>(measure)] = contact_[i] && std::isfinite(error) ? std::abs(error) : kInfinity;
  };
  const auto reference = [&](TaskMeasure measure, double otherwise) {
    return task_[measure] ? task_[measure]->reference.value_or(otherwise) : 0;
  };
  set(TaskMeasure::kEdgeAngle, std::remainder(edge.angle - reference(TaskMeasure::kEdgeAngle, 0), std::numbers::pi));
  set(TaskMeasure::kTotalForce, view.ground_truth.total_force[row] - reference(TaskMeasure::kTotalForce, states_[i].start_force));
  set(TaskMeasure::kCenter, std::hypot(view.ground_truth.center_of_pressure[3 * row] - array_middle_[0],
                                       view.ground_truth.center_of_pressure[3 * row + 1] - array_middle_[1]));
  set(TaskMeasure::kContour, edge.distance);
}

float TaskJudge::lapsOf(const EpisodeState& state) const {
  const double contour = plan_.edges[static_cast<std::size_t>(state.verdict.object)].contourLength();
  return contour > 0 ? static_cast<float>(std::abs(state.progress) / contour) : 0;
}

// Travel and progress since the preceding frame.
void TaskJudge::updateMotion(EpisodeState& state, const Pose& X_SO, double arc) const {
  const Vector3 origin = inverse(X_SO).position;
  if (state.frame > 0) {
    state.verdict.travel += static_cast<float>(length(subtract(origin, state.origin)));
    const TrueEdge& edge = plan_.edges[static_cast<std::size_t>(state.verdict.object)];
    if (task_.laps > 0) state.progress += std::remainder(arc - state.arc, edge.contourLength());
  }
  state.origin = origin;
  state.arc = arc;
}

void TaskJudge::judgeFrame(const FrameView& view, const FrameContext& context, std::size_t i) {
  EpisodeState& state = states_[i];
  Verdict& verdict = state.verdict;
  const std::size_t row = i * static_cast<std::size_t>(context.num_sensors);  // sensor 0
  const double force = view.ground_truth.total_force[row];
  const bool had_contact = contact_[i] != 0;
  contact_[i] = force > 0;
  if (had_contact && !contact_[i]) ++verdict.num_losses;
  verdict.peak_force = std::max(verdict.peak_force, static_cast<float>(force));
  if (view.saturated[row] > 0) verdict.saturated += 1.0f / static_cast<float>(plan_.num_frames);
  verdict.robot |= context.robot_status[i];

  const TrueEdge& true_edge = plan_.edges[static_cast<std::size_t>(verdict.object)];
  const ProjectedEdge edge = needs_edge_ ? true_edge.project(context.X_SO[row]) : ProjectedEdge{kNaN, kNaN, kNaN};
  updateMotion(state, context.X_SO[row], edge.arc);
  updateErrors(i, view, row, edge);

  bool within = contact_[i] != 0;
  for (std::size_t m = 0; m < kNumTaskMeasures; ++m) {
    const double error = errors_[i * kNumTaskMeasures + m];
    if (state.frame == 0) verdict.start_error[m] = static_cast<float>(error);
    if (std::isnan(error)) continue;
    within = within && error <= task_.criteria[m]->tolerance;
    if (state.frame >= plan_.num_frames - num_hold_frames_) state.final_errors[m].push_back(static_cast<float>(error));
  }
  within_[i] = within;
  if (!within) {
    state.within_since = kNaN;
  } else if (std::isnan(state.within_since)) {
    state.within_since = context.times[i];
  }
  ++state.frame;
  travel_[i] = verdict.travel;
  laps_[i] = lapsOf(state);
  peak_force_[i] = verdict.peak_force;
  num_losses_[i] = verdict.num_losses;
}

void TaskJudge::frame(const FrameView& view, const FrameContext& context) {
  context.share(states_.size(), [&](int first, int last) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      if (context.active[i]) judgeFrame(view, context, i);
    }
  });
}

Verdict TaskJudge::verdict(int instance) const {
  const EpisodeState& state = states_[instance];
  Verdict verdict = state.verdict;
  for (std::size_t m = 0; m < state.final_errors.size(); ++m) verdict.steady_error[m] = upperMedian(state.final_errors[m]);
  verdict.settling_time = static_cast<float>(state.within_since);
  verdict.laps = lapsOf(state);
  const double last_time = (plan_.num_frames - num_hold_frames_) * plan_.dt;
  verdict.success =
      state.frame == plan_.num_frames && state.within_since <= last_time && verdict.laps >= task_.laps && verdict.travel >= task_.travel;
  return verdict;
}

}  // namespace taxelsim
