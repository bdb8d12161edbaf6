#include "cli/evaluate_grasp.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/driver_threads.h"
#include "cli/evaluation_report.h"
#include "cli/interrupt.h"
#include "cli/print.h"
#include "cli/processes.h"
#include "episodes/contact_misses.h"
#include "figures/line_chart.h"
#include "figures/text.h"
#include "taxelsim/evaluation_part.h"
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

// Result of a process: the device and a zero, then of each gain the misses by finger and the verdicts by episode and finger.
std::string bytesOf(const std::string& device, const std::vector<GraspEvaluation>& evaluations) {
  std::string bytes = device + '\0';
  for (const GraspEvaluation& evaluation : evaluations) {
    putValues<ContactMisses>(bytes, evaluation.misses);
    for (const GraspVerdict& verdict : evaluation.verdicts) putValues<FingerVerdict>(bytes, verdict.fingers);
  }
  return bytes;
}

// The next gain, from the results of all processes, from which it is taken.
GraspEvaluation nextEvaluation(const Scene& scene, double gain, std::vector<std::string_view>& results) {
  const std::size_t num_fingers = scene.grasp->fingers.size();
  std::vector<GraspVerdict> verdicts;
  std::vector<ContactMisses> sum(num_fingers);
  for (std::size_t number = 0; number < results.size(); ++number) {
    for (std::size_t finger = 0; const ContactMisses& misses : takeValues<ContactMisses>(results[number], num_fingers))
      add(sum[finger++], misses);
    const auto [first, end] = partOfEpisodes(scene.num_episodes, number + 1, results.size());
    for (std::uint64_t episode = first; episode < end; ++episode) {
      GraspVerdict verdict{.episode = episode, .fingers = takeValues<FingerVerdict>(results[number], num_fingers)};
      verdict.success = std::ranges::all_of(verdict.fingers, &FingerVerdict::held);
      verdicts.push_back(std::move(verdict));
    }
  }
  return graspEvaluationOf(scene, gain, std::move(verdicts), std::move(sum));
}

}  // namespace

int evaluateGraspScene(const SceneOptions& options, const Scene& scene, const std::vector<double>& gains, const EvaluationReport& report,
                       int num_processes) {
  num_processes = usableProcesses(num_processes, scene.num_episodes);
  setDriverThreads(num_processes);
  const std::vector<std::string> results = runProcesses(num_processes, [&](const Process& process) {
    GraspEvaluateOptions evaluate;
    evaluate.batch_size = batchShare(std::min(options.batch_size, evaluate.batch_size), num_processes);
    evaluate.stop = &process.stop;
    evaluate.on_progress = process.report;
    evaluate.episodes =
        partOfEpisodes(scene.num_episodes, static_cast<std::uint64_t>(process.number) + 1, static_cast<std::uint64_t>(num_processes));
    const Device device = openDevice(options);
    return bytesOf(deviceText(device.info()), evaluateGrasp(device, scene, gains, evaluate));
  });
  const std::vector<double> all_gains = gains.empty() ? std::vector{scene.grasp->gain} : gains;
  std::vector<GraspEvaluation> evaluations;
  std::vector<ContactMisses> misses(scene.grasp->fingers.size());
  const std::string device = results.front().c_str();
  std::vector<std::string_view> left(results.begin(), results.end());
  for (std::string_view& result : left) result.remove_prefix(result.find('\0') + 1);
  const auto isComplete = [&] { return std::ranges::none_of(left, &std::string_view::empty); };
  while (evaluations.size() < all_gains.size() && isComplete()) {
    evaluations.push_back(nextEvaluation(scene, all_gains[evaluations.size()], left));
    for (std::size_t finger = 0; finger < misses.size(); ++finger) add(misses[finger], evaluations.back().misses[finger]);
  }
  if (evaluations.size() == all_gains.size()) warnOfContactMisses(scene, misses);
  if (!evaluations.empty()) {
    if (report.json) {
      printJson(scene, device, evaluations);
    } else {
      printTable(scene, evaluations);
    }
    if (!report.png.empty()) {
      drawChart(report.png, scene, evaluations);
      spdlog::info("wrote {}", report.png);
    }
  }
  if (!stopOnSignals()) return kExitOk;
  spdlog::warn("stopped: {} of {} gains are evaluated", evaluations.size(), all_gains.size());
  return kExitInterrupted;
}

}  // namespace taxelsim::cli
