#include "episodes/task_evaluator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/vector3.h"

namespace taxelsim {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

constexpr std::size_t at(TaskMeasure measure) {
  return static_cast<std::size_t>(measure);
}

float medianOf(std::vector<float>& values) {
  if (values.empty()) return static_cast<float>(kUnknown);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

int heldFrames(const EpisodePlan& plan) {
  return std::clamp(static_cast<int>(std::lround(plan.scene.task->hold / plan.dt)), 1, plan.num_frames);
}

}  // namespace

TaskEvaluator::TaskEvaluator(const EpisodePlan& plan, std::uint64_t& next, std::vector<Verdict>& verdicts, int num_instances)
    : plan_(plan),
      task_(*plan.scene.task),
      next_(next),
      verdicts_(verdicts),
      needs_edge_(task_[TaskMeasure::kEdgeAngle] || task_[TaskMeasure::kContour] || task_.laps > 0),
      num_held_(heldFrames(plan)),
      middle_(arrayMiddle(plan.scene.sensor)),
      slots_(num_instances) {}

std::optional<std::uint64_t> TaskEvaluator::next(int) {
  if (next_ == verdicts_.size()) return {};
  return next_++;
}

void TaskEvaluator::begin(int instance, const EpisodeRecord& record) {
  Slot& slot = slots_[instance];
  slot.verdict = {.episode = record.episode, .object = record.object, .load_reached = record.load_reached != 0};
  slot.start_force = record.start_force;
  slot.frame = 0;
  slot.within_since = kUnknown;
  slot.touching = false;
  slot.arc = kUnknown;
  slot.progress = 0;
  for (std::vector<float>& held : slot.held) held.clear();
}

// Infinite where they are not known, NaN where the task does not ask for them.
TaskEvaluator::Errors TaskEvaluator::errorsOf(const FrameView& view, std::size_t row, const ProjectedEdge& edge, const Slot& slot) const {
  Errors errors;
  errors.fill(kUnknown);
  const auto set = [&](TaskMeasure measure, double error) {
    if (task_[measure]) errors[at(measure)] = slot.touching && std::isfinite(error) ? std::abs(error) : kInfinite;
  };
  const auto reference = [&](TaskMeasure measure, double otherwise) {
    return task_[measure] ? task_[measure]->reference.value_or(otherwise) : 0;
  };
  set(TaskMeasure::kEdgeAngle, std::remainder(edge.angle - reference(TaskMeasure::kEdgeAngle, 0), std::numbers::pi));
  set(TaskMeasure::kTotalForce, view.ground_truth.total_force[row] - reference(TaskMeasure::kTotalForce, slot.start_force));
  set(TaskMeasure::kCenter, std::hypot(view.ground_truth.center_of_pressure[3 * row] - middle_[0],
                                       view.ground_truth.center_of_pressure[3 * row + 1] - middle_[1]));
  set(TaskMeasure::kContour, edge.distance);
  return errors;
}

void TaskEvaluator::look(const FrameView& view, const FrameContext& context, std::size_t i) {
  Slot& slot = slots_[i];
  Verdict& verdict = slot.verdict;
  const std::size_t row = i * static_cast<std::size_t>(context.num_sensors);  // the first sensor
  const double force = view.ground_truth.total_force[row];
  const bool was_touching = slot.touching;
  slot.touching = force > 0;
  if (was_touching && !slot.touching) ++verdict.num_losses;
  verdict.peak_force = std::max(verdict.peak_force, static_cast<float>(force));
  if (view.saturated[row] > 0) verdict.saturated += 1.0f / static_cast<float>(plan_.num_frames);
  verdict.robot |= context.robots->status()[i];

  const TrueEdge& true_edge = plan_.edges[static_cast<std::size_t>(verdict.object)];
  const ProjectedEdge edge = needs_edge_ ? true_edge.project(context.X_SO[row]) : ProjectedEdge{kUnknown, kUnknown, kUnknown};
  const Vector3 origin = inverse(context.X_SO[row]).position;
  if (slot.frame > 0) {
    verdict.travel += static_cast<float>(length(subtract(origin, slot.origin)));
    if (task_.laps > 0) slot.progress += std::remainder(edge.arc - slot.arc, true_edge.contourLength());
  }
  slot.origin = origin;
  slot.arc = edge.arc;

  const Errors errors = errorsOf(view, row, edge, slot);
  bool within = slot.touching;
  for (std::size_t m = 0; m < errors.size(); ++m) {
    if (std::isnan(errors[m])) continue;
    within = within && errors[m] <= task_.criteria[m]->tolerance;
    if (slot.frame >= plan_.num_frames - num_held_) slot.held[m].push_back(static_cast<float>(errors[m]));
  }
  if (slot.frame == 0) {
    for (std::size_t m = 0; m < errors.size(); ++m) verdict.start_error[m] = static_cast<float>(errors[m]);
  }
  if (!within) {
    slot.within_since = kUnknown;
  } else if (std::isnan(slot.within_since)) {
    slot.within_since = context.times[i];
  }
  ++slot.frame;
}

void TaskEvaluator::frame(const FrameView& view, const FrameContext& context) {
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (context.active[i]) look(view, context, i);
  }
}

void TaskEvaluator::end(int instance) {
  Slot& slot = slots_[instance];
  Verdict& verdict = slot.verdict;
  for (std::size_t m = 0; m < slot.held.size(); ++m) verdict.steady_error[m] = medianOf(slot.held[m]);
  verdict.settling_time = static_cast<float>(slot.within_since);
  const double contour = plan_.edges[static_cast<std::size_t>(verdict.object)].contourLength();
  verdict.laps = contour > 0 ? static_cast<float>(std::abs(slot.progress) / contour) : 0;
  const double last_time = (plan_.num_frames - num_held_) * plan_.dt;
  verdict.success = slot.within_since <= last_time && verdict.laps >= task_.laps && verdict.travel >= task_.travel;
  verdicts_[verdict.episode] = verdict;
}

}  // namespace taxelsim
