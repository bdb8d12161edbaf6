#include "taxelsim/evaluate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include "episodes/batch.h"
#include "episodes/task_evaluator.h"
#include "scene/scene_checks.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::uint64_t kMaxEpisodes = std::uint64_t{1} << 24;  // all verdicts are kept in memory
constexpr int kNumStarts = 5;
constexpr double kLeastRange = 0.1;  // smallest range of start errors, in tolerances, for scores by start
constexpr OutputOptions kNoOutputs{.tactile_normal_force = false, .tactile_shear_force = false, .penetration_depth = false};
constexpr double kNormal95 = 1.959963984540054;  // quantile 0.975 of the standard normal

Quantiles quantilesOf(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  // Smallest value that at least this share of the values does not exceed.
  const auto at = [&](double part) {
    const double rank = std::ceil(part * static_cast<double>(values.size()));
    return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
  };
  return {at(0.5), at(0.95), values.back()};
}

// Range of the start errors of the measure with the widest range, relative to its tolerance.
struct Starts {
  std::size_t measure = 0;
  double lowest = 0, highest = 0;
};

Starts startsOf(const Task& task, const std::vector<Verdict>& verdicts) {
  Starts starts;
  double widest = kLeastRange;
  for (std::size_t m = 0; m < task.criteria.size(); ++m) {
    if (!task.criteria[m]) continue;
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    for (const Verdict& verdict : verdicts) {
      if (!std::isfinite(verdict.start_error[m])) continue;
      lowest = std::min<double>(lowest, verdict.start_error[m]);
      highest = std::max<double>(highest, verdict.start_error[m]);
    }
    const double width = (highest - lowest) / task.criteria[m]->tolerance;
    if (!(width > widest)) continue;
    widest = width;
    starts = {m, lowest, highest};
  }
  return starts;
}

std::vector<Score> scoresByStart(const Starts& starts, const std::vector<Verdict>& verdicts) {
  const auto [measure, lowest, highest] = starts;
  std::vector<Score> scores;
  if (!(highest > lowest)) return scores;
  const double width = (highest - lowest) / kNumStarts;
  std::vector<std::vector<Verdict>> parts(kNumStarts);
  for (const Verdict& verdict : verdicts) {
    const double error = verdict.start_error[measure];
    if (std::isfinite(error)) parts[std::min(static_cast<std::size_t>((error - lowest) / width), parts.size() - 1)].push_back(verdict);
  }
  const auto& [unit, per_si] = kTaskMeasureUnits[measure];
  for (int k = 0; k < kNumStarts; ++k) {
    char name[80];
    std::snprintf(name, sizeof name, "%s error %.3g to %.3g %s at the start", kTaskMeasureNames[measure], (lowest + k * width) * per_si,
                  (lowest + (k + 1) * width) * per_si, unit);
    scores.push_back(scoreOf(name, parts[static_cast<std::size_t>(k)]));
    scores.back().start_error = {lowest + k * width, lowest + (k + 1) * width};
  }
  return scores;
}

// Indices of the named controllers of the scene, or of all.
std::vector<int> numbersOf(const Scene& scene, const std::vector<std::string>& names, bool all) {
  std::vector<int> numbers;
  std::string known;
  for (const SceneController& controller : scene.controllers) known += (known.empty() ? "" : ", ") + controller.name;
  for (const std::string& name : names) {
    const auto found = std::find_if(scene.controllers.begin(), scene.controllers.end(),
                                    [&](const SceneController& controller) { return controller.name == name; });
    if (found == scene.controllers.end()) {
      throw Error(ErrorKind::kInput, scene.file.generic_string() + ": --controller " + name + ": not in this scene; it has " + known);
    }
    numbers.push_back(static_cast<int>(found - scene.controllers.begin()));
  }
  for (int c = 0; all && c < static_cast<int>(scene.controllers.size()); ++c) numbers.push_back(c);
  return numbers;
}

Evaluation evaluationOf(const Scene& scene, const std::string& controller, std::vector<Verdict> verdicts) {
  Evaluation evaluation;
  evaluation.controller = controller;
  evaluation.verdicts = std::move(verdicts);
  evaluation.total = scoreOf("all", evaluation.verdicts);
  for (std::size_t object = 0; object < scene.objects.size(); ++object) {
    std::vector<Verdict> of_object;
    for (const Verdict& verdict : evaluation.verdicts) {
      if (verdict.object == static_cast<int>(object)) of_object.push_back(verdict);
    }
    evaluation.by_object.push_back(scoreOf(scene.objects[object].object.name, of_object));
  }
  const Starts starts = startsOf(*scene.task, evaluation.verdicts);
  evaluation.start_measure = static_cast<int>(starts.measure);
  evaluation.by_start = scoresByStart(starts, evaluation.verdicts);
  return evaluation;
}

}  // namespace

Score scoreOf(const std::string& name, const std::vector<Verdict>& verdicts) {
  Score score;
  score.name = name;
  score.num_episodes = verdicts.size();
  std::vector<double> settling, peak;
  std::array<std::vector<double>, kNumTaskMeasures> steady;
  for (const Verdict& verdict : verdicts) {
    score.num_successes += verdict.success ? 1 : 0;
    settling.push_back(verdict.settling_time);
    peak.push_back(verdict.peak_force);
    for (std::size_t m = 0; m < steady.size(); ++m) steady[m].push_back(verdict.steady_error[m]);
    score.num_lost += verdict.num_losses > 0 ? 1 : 0;
    score.num_saturated += verdict.saturated > 0 ? 1 : 0;
    for (std::size_t bit = 0; bit < score.num_robot.size(); ++bit) score.num_robot[bit] += verdict.robot >> bit & 1;
  }
  score.settling_time = quantilesOf(std::move(settling));
  score.peak_force = quantilesOf(std::move(peak));
  for (std::size_t m = 0; m < steady.size(); ++m) score.steady_error[m] = quantilesOf(std::move(steady[m]));
  if (score.num_episodes == 0) return score;
  const double n = static_cast<double>(score.num_episodes), rate = static_cast<double>(score.num_successes) / n;
  const double z2 = kNormal95 * kNormal95, middle = (rate + z2 / (2 * n)) / (1 + z2 / n);
  const double half = kNormal95 / (1 + z2 / n) * std::sqrt(rate * (1 - rate) / n + z2 / (4 * n * n));
  score.success_rate = rate;
  score.success_low = std::max(0.0, middle - half);
  score.success_high = std::min(1.0, middle + half);
  return score;
}

std::vector<Evaluation> evaluate(const Device& device, const Scene& scene, const std::vector<std::string>& controllers,
                                 const EvaluateOptions& options) {
  checkCount("batch size", options.batch_size);
  checkCount("slices", options.num_slices);
  checkScene(scene);
  if (!scene.task) throw Error(ErrorKind::kInput, scene.file.generic_string() + ": this scene has no `task`, which `evaluate` needs");
  if (scene.num_episodes > kMaxEpisodes) {
    throw Error(ErrorKind::kInput, "episodes: " + std::to_string(scene.num_episodes) + " found, at most " + std::to_string(kMaxEpisodes) +
                                       " allowed in one evaluation");
  }
  // The policy is the first, so that its exceptions lose no complete evaluation.
  std::vector<SlicePlan> plans;
  std::vector<std::string> names;
  if (options.policy) {
    plans.emplace_back(scene, kNoOutputs, *options.policy);
    names.push_back(options.policy->name);
  }
  for (const int number : numbersOf(scene, controllers, controllers.empty() && !options.policy)) {
    plans.emplace_back(scene, kNoOutputs, number);
    names.push_back(scene.controllers[static_cast<std::size_t>(number)].name);
  }
  const Model model(device, modelOptionsOf(scene));
  const int batch_size = static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(options.batch_size), scene.num_episodes));
  const auto stopped = [&] { return options.stop && options.stop->load(std::memory_order_relaxed); };

  Progress progress;
  progress.num_episodes = scene.num_episodes * plans.size();
  progress.num_frames = progress.num_episodes * static_cast<std::uint64_t>(numFrames(scene));
  const auto start = std::chrono::steady_clock::now();
  std::vector<Evaluation> evaluations;
  for (std::size_t p = 0; p < plans.size(); ++p) {
    const SlicePlan& plan = plans[p];
    std::vector<Verdict> verdicts(scene.num_episodes);
    int first_instance = 0;
    std::uint64_t next = 0;
    std::vector<std::unique_ptr<TaskEvaluator>> evaluators;
    std::vector<std::unique_ptr<Slice>> slices;
    for (const int size : splitBatch(model, plan, batch_size, options.num_slices)) {
      evaluators.push_back(std::make_unique<TaskEvaluator>(plan, next, verdicts, size));
      slices.push_back(std::make_unique<Slice>(model, plan, size, *evaluators.back(), first_instance));
      first_instance += size;
    }
    runEpisodes(device, slices, options.stop, [&](const Slice::Stats& tally) {
      progress.frames_done += tally.num_frames;
      progress.episodes_done += tally.num_episodes;
      progress.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      if (options.on_progress) options.on_progress(progress);
    });
    if (stopped()) break;
    evaluations.push_back(evaluationOf(scene, names[p], std::move(verdicts)));
  }
  return evaluations;
}

}  // namespace taxelsim
