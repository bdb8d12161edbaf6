// `taxelsim evaluate`: evaluates controllers on a scene's task.
#include "taxelsim/evaluate.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "cli/commands.h"
#include "cli/driver_threads.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/scene_options.h"
#include "figures/line_chart.h"
#include "figures/text.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

using Json = nlohmann::ordered_json;

struct Arguments : SceneOptions {
  std::string png;
  std::vector<std::string> controllers;
  bool json = false;
};

constexpr std::array<const char*, 4> kRobotBits = {"joint_limit", "velocity_limit", "singular", "lost"};

std::string quantilesText(const Quantiles& quantiles, double per_si) {
  if (std::isnan(quantiles.median)) return "-";
  return fmt::format("{:.3g} / {:.3g}", quantiles.median * per_si, quantiles.p95 * per_si);
}

std::vector<std::string> rowOf(const Task& task, const std::string& controller, const Score& score) {
  std::vector<std::string> row{controller, score.name, countText(score.num_episodes)};
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
  std::vector<std::string> heading{"controller", "episodes of", "episodes", "success (95 %)", "settling s"};
  for (std::size_t m = 0; m < scene.task->criteria.size(); ++m) {
    if (scene.task->criteria[m]) heading.push_back(fmt::format("{} {}", kTaskMeasureNames[m], kTaskMeasureUnits[m].name));
  }
  heading.insert(heading.end(), {"peak force N", "lost contact", "saturated"});
  std::vector<std::vector<std::string>> rows{heading};
  for (const Evaluation& evaluation : evaluations) {
    rows.push_back(rowOf(*scene.task, evaluation.controller, evaluation.total));
    if (evaluation.by_object.size() > 1) {
      for (const Score& score : evaluation.by_object) rows.push_back(rowOf(*scene.task, "", score));
    }
    for (const Score& score : evaluation.by_start) rows.push_back(rowOf(*scene.task, "", score));
  }
  fmt::print("{}: steady error = median over the last {:.3g} s of an episode; columns show median / 95th percentile over episodes\n\n{}",
             sceneTitle(scene), scene.task->hold, tableText(rows));
  for (const Evaluation& evaluation : evaluations) {
    for (std::size_t bit = 0; bit < kRobotBits.size(); ++bit) {
      if (evaluation.total.num_robot[bit] == 0) continue;
      fmt::print("\n{}: robot {} in {} episodes", evaluation.controller, kRobotBits[bit], countText(evaluation.total.num_robot[bit]));
    }
  }
  fmt::print("\n");
}

// null for values that are not finite, which JSON cannot represent.
Json numberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json asJson(const Quantiles& quantiles) {
  return {{"median", numberOrNull(quantiles.median)}, {"p95", numberOrNull(quantiles.p95)}, {"max", numberOrNull(quantiles.max)}};
}

Json asJson(const Task& task, const Score& score) {
  Json json{{"name", score.name},
            {"episodes", score.num_episodes},
            {"successes", score.num_successes},
            {"success_rate", score.success_rate},
            {"success_rate_95", {score.success_low, score.success_high}},
            {"settling_time", asJson(score.settling_time)}};
  for (std::size_t m = 0; m < task.criteria.size(); ++m) {
    if (task.criteria[m]) json["steady_error"][kTaskMeasureNames[m]] = asJson(score.steady_error[m]);
  }
  json["peak_force"] = asJson(score.peak_force);
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

void printJson(const Scene& scene, const Device& device, const std::vector<Evaluation>& evaluations) {
  Json json{{"scene", scene.name}, {"seed", scene.seed}, {"device", device.info().name + ", " + device.info().driver}};
  if (!scene.conditions.empty()) json["condition"] = scene.condition;
  json["controllers"] = Json::array();
  for (const Evaluation& evaluation : evaluations) {
    Json entry{{"controller", evaluation.controller}, {"total", asJson(*scene.task, evaluation.total)}};
    for (const Score& score : evaluation.by_object) entry["by_object"].push_back(asJson(*scene.task, score));
    for (const Score& score : evaluation.by_start) entry["by_start"].push_back(asJson(*scene.task, score));
    for (const Verdict& verdict : evaluation.verdicts) entry["episodes"].push_back(asJson(scene, verdict));
    json["controllers"].push_back(std::move(entry));
  }
  fmt::print("{}\n", json.dump(2));
}

// Cumulative share of episodes (%) over their values; values that are not finite count in the total only.
LineSeries cumulative(const std::string& name, std::vector<double> values) {
  const double all = static_cast<double>(values.size());
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  std::sort(values.begin(), values.end());
  LineSeries series{.name = name, .x = {}, .y = {}};
  for (std::size_t k = 0; k < values.size(); ++k) {
    for (const double count : {static_cast<double>(k), static_cast<double>(k + 1)}) {
      series.x.push_back(values[k]);
      series.y.push_back(100 * count / all);
    }
  }
  return series;
}

void drawChart(const std::string& file, const Scene& scene, const std::vector<Evaluation>& evaluations) {
  const auto collect = [](const Evaluation& evaluation, auto value) {
    std::vector<double> values;
    for (const Verdict& verdict : evaluation.verdicts) values.push_back(value(verdict));
    return values;
  };
  constexpr std::array<double, 2> kPercent{0, 100};
  LinePanel settled{.title = "Settled episodes over time", .x_label = "time, s", .y_label = "episodes, %", .y_range = kPercent};
  for (const Evaluation& evaluation : evaluations) {
    settled.series.push_back(cumulative(evaluation.controller, collect(evaluation, [](const Verdict& v) { return v.settling_time; })));
  }
  std::vector<LinePanel> panels{settled};
  for (std::size_t m = 0; m < scene.task->criteria.size(); ++m) {
    if (!scene.task->criteria[m]) continue;
    const auto& [unit, per_si] = kTaskMeasureUnits[m];
    LinePanel panel{.title = fmt::format("Steady {}", kTaskMeasureNames[m]),
                    .x_label = fmt::format("error at most, {}", unit),
                    .y_label = "episodes, %",
                    .marks = {{scene.task->criteria[m]->tolerance * per_si, "tolerance"}},
                    .y_range = kPercent};
    for (const Evaluation& evaluation : evaluations) {
      panel.series.push_back(cumulative(
          evaluation.controller, collect(evaluation, [m, factor = per_si](const Verdict& v) { return v.steady_error[m] * factor; })));
    }
    panels.push_back(std::move(panel));
  }
  LinePanel by_start{.title = "Success by start error", .y_label = "episodes, %", .y_range = kPercent};
  for (const Evaluation& evaluation : evaluations) {
    const auto measure = static_cast<std::size_t>(evaluation.start_measure);
    const auto& [unit, per_si] = kTaskMeasureUnits[measure];
    by_start.x_label = fmt::format("{} at the start, {}", kTaskMeasureNames[measure], unit);
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

int runEvaluate(const Arguments& arguments) {
  const Scene scene = loadScene(arguments.scene, arguments.overrides);
  useTwoDriverThreadsPerCore();
  const Device device = Device::open({.device = arguments.device, .validation = arguments.validation});
  ProgressPrinter printer;
  EvaluateOptions options;
  options.batch_size = arguments.batch_size;
  options.stop = &stopOnSignals();
  bool announced = false;
  options.on_progress = [&](const Progress& progress) {
    if (!std::exchange(announced, true)) {
      spdlog::info("{}: {} episodes per controller on {} ({})", sceneTitle(scene), countText(scene.num_episodes), device.info().name,
                   device.info().driver);
    }
    printer.show(progress);
  };
  const std::vector<Evaluation> evaluations = evaluate(device, scene, arguments.controllers, options);
  printer.clear();
  if (*options.stop) {
    spdlog::warn("stopped; completed controllers: {}", evaluations.size());
    return kExitInterrupted;
  }
  if (!arguments.png.empty()) drawChart(arguments.png, scene, evaluations);
  if (arguments.json) {
    printJson(scene, device, evaluations);
  } else {
    printTable(scene, evaluations);
  }
  return kExitOk;
}

}  // namespace

void addEvaluate(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("evaluate", "Evaluate controllers on a scene's task, same episodes for each");
  command->footer(
      "Example:\n  taxelsim evaluate scenes/tasks/align_edge.yaml --episodes 10000\n"
      "Scored on ground truth, not on sensor readings. Results do not depend on the batch size.");
  const auto arguments = std::make_shared<Arguments>();
  addSceneOptions(*command, *arguments, EvaluateOptions{}.batch_size);
  command->add_option("--controller", arguments->controllers, "Name of a controller of the scene; may be repeated. Default: all")
      ->type_name("NAME");
  command->add_option("--png", arguments->png, "Figure to write (PNG): settling, errors and success by start error")->type_name("FILE");
  command->add_flag("--json", arguments->json, "Print JSON with every episode");
  command->callback([=, &action] { action = [=] { return runEvaluate(*arguments); }; });
}

}  // namespace taxelsim::cli
