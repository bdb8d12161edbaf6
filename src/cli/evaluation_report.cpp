#include "cli/evaluation_report.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "cli/print.h"
#include "cli/scene_options.h"
#include "figures/line_chart.h"
#include "figures/text.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 4> kRobotBits = {"joint_limit", "velocity_limit", "singular", "lost"};

std::string measureText(TaskMeasure measure, double value) {
  const auto& [unit, per_si] = kTaskMeasureUnits[static_cast<std::size_t>(measure)];
  return fmt::format("{:.4g} {}", value * per_si, unit);
}

// "edge_angle within 5 deg of 90 deg"
std::string criterionText(TaskMeasure measure, const TaskCriterion& criterion) {
  const std::string text =
      fmt::format("{} within {}", kTaskMeasureNames[static_cast<std::size_t>(measure)], measureText(measure, criterion.tolerance));
  switch (measure) {
    case TaskMeasure::kEdgeAngle:
      return text + " of " + measureText(measure, criterion.reference.value_or(0));
    case TaskMeasure::kTotalForce:
      return text + " of " + (criterion.reference ? measureText(measure, *criterion.reference) : "the force at the start");
    case TaskMeasure::kCenter:
      return text + " of the middle of the array";
    case TaskMeasure::kContour:
      return text + " of the origin of the sensor";
  }
  return text;
}

// What an episode must meet to count as a success; see Task.
std::string successRule(const Task& task) {
  std::string rule = fmt::format("success: in every frame of the last {:.4g} s, contact", task.hold);
  for (std::size_t m = 0; m < task.criteria.size(); ++m) {
    if (task.criteria[m]) rule += ", " + criterionText(static_cast<TaskMeasure>(m), *task.criteria[m]);
  }
  if (task.laps > 0) rule += fmt::format("; at least {:.4g} turns around the contour", task.laps);
  if (task.travel > 0) rule += fmt::format("; a path of at least {:.4g} mm over the object", 1e3 * task.travel);
  return rule;
}

// `subset`: the episodes that the score is of.
std::vector<std::string> rowOf(const Task& task, const std::string& controller, const std::string& subset, const Score& score) {
  std::vector<std::string> row{controller, subset, countText(score.num_episodes)};
  row.push_back(score.num_episodes == 0 ? "-"
                                        : fmt::format("{:.2f} % ({:.2f} to {:.2f})", 100 * score.success_rate, 100 * score.success_low,
                                                      100 * score.success_high));
  row.push_back(quantilesText(score.settling_time, 1));
  for (std::size_t m = 0; m < task.criteria.size(); ++m) {
    if (task.criteria[m]) row.push_back(quantilesText(score.steady_error[m], kTaskMeasureUnits[m].per_si));
  }
  row.push_back(quantilesText(score.peak_force, 1));
  row.push_back(countText(score.num_lost));
  row.push_back(countText(score.num_saturated));
  return row;
}

void printTable(const Scene& scene, const std::vector<Evaluation>& evaluations) {
  std::vector<std::string> heading{"controller", "subset", "episodes", "success (95 %)", "settling s"};
  for (std::size_t m = 0; m < scene.task->criteria.size(); ++m) {
    if (scene.task->criteria[m]) heading.push_back(fmt::format("{} error {}", kTaskMeasureNames[m], kTaskMeasureUnits[m].name));
  }
  heading.insert(heading.end(), {"peak force N", "lost contact", "saturated"});
  std::vector<std::vector<std::string>> rows{heading};
  for (const Evaluation& evaluation : evaluations) {
    rows.push_back(rowOf(*scene.task, evaluation.controller, evaluation.total.name, evaluation.total));
    if (evaluation.by_object.size() > 1) {
      for (const Score& score : evaluation.by_object) rows.push_back(rowOf(*scene.task, "", "object " + score.name, score));
    }
    for (const Score& score : evaluation.by_start) rows.push_back(rowOf(*scene.task, "", score.name, score));
  }
  printOut(
      "{}: {} episodes per controller\n{}\nerror: median over the last {:.4g} s of an episode; columns show median / 95th percentile over "
      "episodes\n\n{}",
      sceneTitle(scene), countText(scene.num_episodes), successRule(*scene.task), scene.task->hold, tableText(rows));
  for (const Evaluation& evaluation : evaluations) {
    for (std::size_t bit = 0; bit < kRobotBits.size(); ++bit) {
      if (evaluation.total.num_robot[bit] == 0) continue;
      printOut("\n{}: robot {} in {} episodes", evaluation.controller, kRobotBits[bit], countText(evaluation.total.num_robot[bit]));
    }
  }
  printOut("\n");
}

Json asJson(const Task& task, const Score& score) {
  Json json{{"name", score.name},
            {"episodes", score.num_episodes},
            {"successes", score.num_successes},
            {"success_rate", score.success_rate},
            {"success_rate_95", {score.success_low, score.success_high}},
            {"settling_time", quantilesJson(score.settling_time)}};
  for (std::size_t m = 0; m < task.criteria.size(); ++m) {
    if (task.criteria[m]) json["steady_error"][kTaskMeasureNames[m]] = quantilesJson(score.steady_error[m]);
  }
  json["peak_force"] = quantilesJson(score.peak_force);
  json["episodes_lost_contact"] = score.num_lost;
  json["episodes_saturated"] = score.num_saturated;
  for (std::size_t bit = 0; bit < kRobotBits.size(); ++bit) json["episodes_robot"][kRobotBits[bit]] = score.num_robot[bit];
  return json;
}

Json asJson(const Scene& scene, const Verdict& verdict) {
  Json json{{"episode", verdict.episode},
            {"object", scene.objects[static_cast<std::size_t>(verdict.object)].object.name},
            {"success", verdict.success},
            {"settling_time", numberOrNull(verdict.settling_time)}};
  for (std::size_t m = 0; m < scene.task->criteria.size(); ++m) {
    if (!scene.task->criteria[m]) continue;
    json["start_error"][kTaskMeasureNames[m]] = numberOrNull(verdict.start_error[m]);
    json["steady_error"][kTaskMeasureNames[m]] = numberOrNull(verdict.steady_error[m]);
  }
  json["travel"] = verdict.travel;
  json["laps"] = verdict.laps;
  json["peak_force"] = verdict.peak_force;
  json["saturated"] = verdict.saturated;
  json["contact_losses"] = verdict.num_losses;
  json["robot_status"] = verdict.robot;
  json["load_reached"] = verdict.load_reached;
  return json;
}

void printJson(const Scene& scene, const std::string& device, const std::vector<Evaluation>& evaluations) {
  Json json{{"scene", scene.name}, {"seed", scene.seed}, {"device", device}, {"success", successRule(*scene.task)}};
  if (!scene.conditions.empty()) json["condition"] = scene.condition;
  json["controllers"] = Json::array();
  for (const Evaluation& evaluation : evaluations) {
    Json entry{{"controller", evaluation.controller}, {"total", asJson(*scene.task, evaluation.total)}};
    for (const Score& score : evaluation.by_object) entry["by_object"].push_back(asJson(*scene.task, score));
    for (const Score& score : evaluation.by_start) entry["by_start"].push_back(asJson(*scene.task, score));
    for (const Verdict& verdict : evaluation.verdicts) entry["episodes"].push_back(asJson(scene, verdict));
    json["controllers"].push_back(std::move(entry));
  }
  printJsonText(json);
}

// From 0 to the largest value of the series, which are >= 0; to `otherwise` if all are 0.
std::array<double, 2> rangeFromZero(const std::vector<LineSeries>& all, double otherwise) {
  double most = 0;
  for (const LineSeries& series : all) {
    if (!series.x.empty()) most = std::max(most, *std::max_element(series.x.begin(), series.x.end()));
  }
  return {0, most > 0 ? most : otherwise};
}

void drawChart(const std::string& file, const Scene& scene, const std::vector<Evaluation>& evaluations) {
  const auto collect = [](const Evaluation& evaluation, auto value) {
    std::vector<double> values;
    for (const Verdict& verdict : evaluation.verdicts) values.push_back(value(verdict));
    return values;
  };
  constexpr std::array<double, 2> kPercent{0, 100};
  LinePanel settled{.title = "Settled episodes over time",
                    .x_label = "time, s",
                    .y_label = "episodes, %",
                    .x_range = std::array{0.0, scene.num_steps / scene.simulation_rate},
                    .y_range = kPercent};
  for (const Evaluation& evaluation : evaluations) {
    settled.series.push_back(cumulativeShare(evaluation.controller, collect(evaluation, [](const Verdict& v) { return v.settling_time; })));
  }
  std::vector<LinePanel> panels{settled};
  for (std::size_t m = 0; m < scene.task->criteria.size(); ++m) {
    if (!scene.task->criteria[m]) continue;
    const auto& [unit, per_si] = kTaskMeasureUnits[m];
    LinePanel panel{.title = fmt::format("Steady error: {}", kTaskMeasureNames[m]),
                    .x_label = fmt::format("error at most, {}", unit),
                    .y_label = "episodes, %",
                    .marks = {{scene.task->criteria[m]->tolerance * per_si, "tolerance"}},
                    .y_range = kPercent};
    for (const Evaluation& evaluation : evaluations) {
      panel.series.push_back(cumulativeShare(
          evaluation.controller, collect(evaluation, [m, factor = per_si](const Verdict& v) { return v.steady_error[m] * factor; })));
    }
    panel.x_range = rangeFromZero(panel.series, panel.marks.front().x);
    panels.push_back(std::move(panel));
  }
  LinePanel by_start{.title = "Success by start error", .y_label = "episodes, %", .y_range = kPercent};
  for (const Evaluation& evaluation : evaluations) {
    const auto measure = static_cast<std::size_t>(evaluation.start_measure);
    const auto& [unit, per_si] = kTaskMeasureUnits[measure];
    by_start.x_label = fmt::format("{} error at the start, {}", kTaskMeasureNames[measure], unit);
    LineSeries series{.name = evaluation.controller, .x = {}, .y = {}};
    for (const Score& score : evaluation.by_start) {
      if (score.num_episodes == 0) continue;
      series.x.push_back(per_si * (score.start_error[0] + score.start_error[1]) / 2);
      series.y.push_back(100 * score.success_rate);
      series.low.push_back(100 * score.success_low);
      series.high.push_back(100 * score.success_high);
    }
    if (!series.x.empty()) by_start.series.push_back(std::move(series));
  }
  if (!by_start.series.empty()) panels.push_back(std::move(by_start));
  writeLineChart(file, panels,
                 {.title = sceneTitle(scene),
                  .subtitle = fmt::format("{} episodes per controller; 95 % intervals", countText(scene.num_episodes)),
                  .num_columns = panels.size() > 3 ? 3 : static_cast<int>(panels.size())});
}

// Objects that could not carry the load of every episode; such an episode begins with the deepest contact.
void warnOfLoads(const Scene& scene, const Evaluation& evaluation) {
  std::vector<std::uint64_t> num_misses(scene.objects.size()), num_episodes(scene.objects.size());
  for (const Verdict& verdict : evaluation.verdicts) {
    const auto object = static_cast<std::size_t>(verdict.object);
    ++num_episodes[object];
    if (!verdict.load_reached) ++num_misses[object];
  }
  for (std::size_t object = 0; object < num_misses.size(); ++object) {
    if (num_misses[object] == 0) continue;
    spdlog::warn("object {}: load out of reach in {} of its {} episodes; they begin with the deepest contact",
                 scene.objects[object].object.name, countText(num_misses[object]), countText(num_episodes[object]));
  }
}

}  // namespace

std::string quantilesText(const Quantiles& quantiles, double per_si) {
  if (std::isnan(quantiles.median)) return "-";
  return fmt::format("{:.3g} / {:.3g}", quantiles.median * per_si, quantiles.p95 * per_si);
}

nlohmann::ordered_json quantilesJson(const Quantiles& quantiles) {
  return {{"median", numberOrNull(quantiles.median)}, {"p95", numberOrNull(quantiles.p95)}, {"max", numberOrNull(quantiles.max)}};
}

void reportBy(const EvaluationReport& report, const std::function<void()>& print_json, const std::function<void()>& print_table,
              const std::function<void()>& draw) {
  report.json ? print_json() : print_table();
  if (report.png.empty()) return;
  draw();
  spdlog::info("wrote {}", report.png);
}

void reportEvaluations(const EvaluationReport& report, const Scene& scene, const std::string& device,
                       const std::vector<Evaluation>& evaluations) {
  warnOfLoads(scene, evaluations.front());  // the same episodes for all controllers
  reportBy(
      report, [&] { printJson(scene, device, evaluations); }, [&] { printTable(scene, evaluations); },
      [&] { drawChart(report.png, scene, evaluations); });
}

}  // namespace taxelsim::cli
