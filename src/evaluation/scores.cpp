#include "evaluation/scores.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace taxelsim {
namespace {

constexpr int kNumStarts = 5;
constexpr double kLeastRange = 0.1;              // smallest range of start errors, in tolerances, for scores by start
constexpr double kNormal95 = 1.959963984540054;  // quantile 0.975 of the standard normal

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

}  // namespace

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

std::array<double, 2> wilsonInterval(std::uint64_t num_successes, std::uint64_t num_all) {
  const double n = static_cast<double>(num_all), rate = static_cast<double>(num_successes) / n;
  const double z2 = kNormal95 * kNormal95, middle = (rate + z2 / (2 * n)) / (1 + z2 / n);
  const double half = kNormal95 / (1 + z2 / n) * std::sqrt(rate * (1 - rate) / n + z2 / (4 * n * n));
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
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
  score.success_rate = static_cast<double>(score.num_successes) / static_cast<double>(score.num_episodes);
  const auto [low, high] = wilsonInterval(score.num_successes, score.num_episodes);
  score.success_low = low;
  score.success_high = high;
  return score;
}

}  // namespace taxelsim
