#include "figures/grasp_report.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "figures/line_chart.h"
#include "figures/text.h"

namespace taxelsim::figures {
namespace {

std::string numberText(double value, double per_si, int digits) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value * per_si, digits);
}

nlohmann::ordered_json numberOrNull(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

std::string graspTable(const GraspExperiment& experiment, const std::vector<GraspRun>& runs) {
  const GraspTask& task = experiment.scene.grasp->task;
  std::vector<std::vector<std::string>> rows{
      {"gain 1/s", "finger", "target N", "contact s", "settling s", "overshoot %", "rms error N", "decay per frame", "in theory"}};
  for (const GraspRun& run : runs) {
    for (const GraspFingerTrace& finger : run.fingers) {
      rows.push_back({fmt::format("{:.4g}", run.gain), finger.name, numberText(finger.target, 1, 3), numberText(finger.first_contact, 1, 2),
                      numberText(finger.settling_time, 1, 2), numberText(finger.overshoot, 100, 1), numberText(finger.steady_rms, 1, 4),
                      numberText(finger.decay, 1, 3), numberText(run.expected_decay, 1, 3)});
    }
  }
  return fmt::format(
      "{}: settling = stays within {:.4g} % of the target; rms error of the last {:.4g} s; decay of the error from a half to a tenth of "
      "the\n"
      "target, in theory for a contact of constant stiffness\n\n{}\n",
      experiment.name, 100 * task.tolerance, task.hold, tableText(rows));
}

nlohmann::ordered_json graspJson(const GraspExperiment& experiment, const std::vector<GraspRun>& runs) {
  nlohmann::ordered_json json{{"experiment", experiment.name}, {"runs", nlohmann::ordered_json::array()}};
  for (const GraspRun& run : runs) {
    nlohmann::ordered_json entry{{"gain", run.gain}, {"expected_decay", run.expected_decay}, {"time", run.time}};
    for (const GraspFingerTrace& finger : run.fingers) {
      entry["fingers"].push_back({{"finger", finger.name},
                                  {"target_force", finger.target},
                                  {"first_contact", numberOrNull(finger.first_contact)},
                                  {"settling_time", numberOrNull(finger.settling_time)},
                                  {"overshoot", finger.overshoot},
                                  {"steady_rms", finger.steady_rms},
                                  {"decay", numberOrNull(finger.decay)},
                                  {"force", finger.force}});
    }
    json["runs"].push_back(std::move(entry));
  }
  return json;
}

void drawGrasp(const std::filesystem::path& directory, const GraspExperiment& experiment, const std::vector<GraspRun>& runs) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  std::vector<LinePanel> panels;
  for (std::size_t f = 0; f < runs.front().fingers.size(); ++f) {
    const GraspFingerTrace& first = runs.front().fingers[f];
    LinePanel panel{.title = first.name, .x_label = "time, s", .y_label = "force, N", .reference = LineLevel{first.target, "target"}};
    for (const GraspRun& run : runs) {
      panel.series.push_back({.name = fmt::format("gain {:.4g} 1/s", run.gain), .x = run.time, .y = run.fingers[f].force});
    }
    panels.push_back(std::move(panel));
  }
  writeLineChart(directory / "forces.png", panels,
                 {.title = experiment.name, .subtitle = "clean total force of each finger", .num_columns = panels.size() > 3 ? 3 : 0});
}

}  // namespace taxelsim::figures
