#include "cli/evaluate_grasp.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/evaluation_report.h"
#include "cli/print.h"
#include "figures/line_chart.h"
#include "figures/text.h"
#include "taxelsim/grasp_evaluation.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

using Json = nlohmann::ordered_json;

std::string successRule(const GraspTask& task) {
  std::string rule = fmt::format("success: in every frame of the last {:.4g} s, the force of each finger within {:.4g} % of its target",
                                 task.hold, 100 * task.tolerance);
  if (task.drift) rule += fmt::format(", and its centre of pressure within {:.4g} mm of where it was", 1e3 * *task.drift);
  return rule;
}

// `gain`: text of its cell.
std::vector<std::string> rowOf(const std::string& gain, const FingerScore& score) {
  return {gain,
          score.name,
          countText(score.num_episodes),
          fmt::format("{:.2f} % ({:.2f} to {:.2f})", 100 * score.held_rate, 100 * score.held_low, 100 * score.held_high),
          quantilesText(score.settling_time, 1),
          quantilesText(score.force_error, 1),
          quantilesText(score.drift, 1e3),
          quantilesText(score.peak_force, 1),
          countText(score.num_lost)};
}

void printTable(const Scene& scene, const std::vector<GraspEvaluation>& evaluations) {
  std::vector<std::vector<std::string>> rows{
      {"gain 1/s", "finger", "episodes", "success (95 %)", "settling s", "force error N", "drift mm", "peak force N", "lost contact"}};
  for (const GraspEvaluation& evaluation : evaluations) {
    rows.push_back(rowOf(fmt::format("{:.4g}", evaluation.gain), evaluation.total));
    for (const FingerScore& score : evaluation.fingers) rows.push_back(rowOf("", score));
  }
  printOut(
      "{}: {} episodes per gain\n{}\nforce error: root mean square over the last {:.4g} s; drift: of the centre of pressure in them; "
      "columns "
      "show median / 95th percentile over episodes,\nfor all fingers of the finger with the largest value\n\n{}\n",
      scene.name, countText(scene.num_episodes), successRule(scene.grasp->task), scene.grasp->task.hold, tableText(rows));
}

Json asJson(const FingerScore& score) {
  return {{"name", score.name},
          {"episodes", score.num_episodes},
          {"successes", score.num_held},
          {"success_rate", score.held_rate},
          {"success_rate_95", {score.held_low, score.held_high}},
          {"settling_time", quantilesJson(score.settling_time)},
          {"force_error", quantilesJson(score.force_error)},
          {"drift", quantilesJson(score.drift)},
          {"peak_force", quantilesJson(score.peak_force)},
          {"episodes_lost_contact", score.num_lost}};
}

Json asJson(const FingerVerdict& finger) {
  return {{"success", finger.held},
          {"target_force", finger.target},
          {"settling_time", numberOrNull(finger.settling_time)},
          {"force_error", finger.force_error},
          {"drift", numberOrNull(finger.drift)},
          {"peak_force", finger.peak_force},
          {"contact_losses", finger.num_losses}};
}

void printJson(const Scene& scene, const std::string& device, const std::vector<GraspEvaluation>& evaluations) {
  Json json{{"scene", scene.name}, {"seed", scene.seed}, {"device", device}, {"success", successRule(scene.grasp->task)}};
  json["gains"] = Json::array();
  for (const GraspEvaluation& evaluation : evaluations) {
    Json entry{{"gain", evaluation.gain}, {"total", asJson(evaluation.total)}};
    for (const FingerScore& score : evaluation.fingers) entry["by_finger"].push_back(asJson(score));
    for (const GraspVerdict& verdict : evaluation.verdicts) {
      Json episode{{"episode", verdict.episode}, {"success", verdict.success}};
      for (std::size_t f = 0; f < verdict.fingers.size(); ++f) episode["fingers"][evaluation.fingers[f].name] = asJson(verdict.fingers[f]);
      entry["episodes"].push_back(std::move(episode));
    }
    json["gains"].push_back(std::move(entry));
  }
  printJsonText(json);
}

// Share of episodes whose finger has settled, over time, a panel per finger and a line per gain.
void drawChart(const std::string& file, const Scene& scene, const std::vector<GraspEvaluation>& evaluations) {
  std::vector<LinePanel> panels;
  for (std::size_t f = 0; f < scene.grasp->fingers.size(); ++f) {
    LinePanel panel{.title = "Settled: " + evaluations.front().fingers[f].name,
                    .x_label = "time, s",
                    .y_label = "episodes, %",
                    .x_range = std::array{0.0, scene.num_steps / scene.simulation_rate},
                    .y_range = std::array{0.0, 100.0}};
    for (const GraspEvaluation& evaluation : evaluations) {
      std::vector<double> times;
      for (const GraspVerdict& verdict : evaluation.verdicts) times.push_back(verdict.fingers[f].settling_time);
      panel.series.push_back(cumulativeShare(fmt::format("gain {:.4g} 1/s", evaluation.gain), std::move(times)));
    }
    panels.push_back(std::move(panel));
  }
  const int num_columns = panels.size() > 3 ? 3 : static_cast<int>(panels.size());
  writeLineChart(file, panels,
                 {.title = scene.name, .subtitle = countText(scene.num_episodes) + " episodes per gain", .num_columns = num_columns});
}

}  // namespace

void reportGrasps(const EvaluationReport& report, const Scene& scene, const std::string& device,
                  const std::vector<GraspEvaluation>& evaluations) {
  reportBy(
      report, [&] { printJson(scene, device, evaluations); }, [&] { printTable(scene, evaluations); },
      [&] { drawChart(report.png, scene, evaluations); });
}

}  // namespace taxelsim::cli
