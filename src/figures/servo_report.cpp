#include "figures/servo_report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/constants.h"
#include "figures/text.h"

namespace taxelsim::figures {
namespace {

// Name and unit of a feature in tables.
struct FeatureText {
  const char* name;
  const char* unit;
  double scale;  // of the unit, in SI
};

FeatureText textOf(ServoFeature feature) {
  switch (feature) {
    case ServoFeature::kCenterX:
      return {"center_x", "mm", 1e-3};
    case ServoFeature::kCenterY:
      return {"center_y", "mm", 1e-3};
    case ServoFeature::kCenterAcross:
      return {"center_across", "mm", 1e-3};
    case ServoFeature::kTotalForce:
      return {"total_force", "N", 1};
    case ServoFeature::kEdgeAngle:
      return {"edge_angle", "deg", kRadPerDegree};
    case ServoFeature::kTiltX:
      return {"tilt_x", "deg", kRadPerDegree};
    case ServoFeature::kTiltY:
      return {"tilt_y", "deg", kRadPerDegree};
  }
  return {"", "", 1};
}

std::string fixed(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  std::string text = fmt::format("{:.{}f}", value, digits);
  if (text.starts_with('-') && text.find_first_of("123456789") == std::string::npos) text.erase(0, 1);
  return text;
}

// Empty if no run controls the feature.
std::string featureTable(const ServoExperiment& experiment, const ServoResult& result, ServoFeature feature) {
  const FeatureText text = textOf(feature);
  const bool is_angle = feature == ServoFeature::kEdgeAngle;
  std::vector<std::string> heading{text.name, "start", "settling s"};
  if (is_angle) heading.insert(heading.end(), {"theory s", "deviation"});
  heading.insert(heading.end(), {"overshoot %", "mean", "rms", "max"});
  std::vector<std::vector<std::string>> rows{heading};
  for (std::size_t r = 0; r < result.runs.size(); ++r) {
    const ServoRunResult& run = result.runs[r];
    const ServoConvergence* convergence = convergenceOf(run, feature);
    if (convergence == nullptr) continue;
    std::vector<std::string> row{experiment.runs[r].name, fixed(convergence->error.front() / text.scale, 3),
                                 fixed(convergence->settling_time, 3)};
    if (is_angle) {
      const bool has_theory = !run.expected_error.empty();
      row.push_back(has_theory ? fixed(run.expected_settling_time, 3) : "-");
      row.push_back(has_theory ? fixed(run.largest_deviation / kRadPerDegree, 4) : "-");
    }
    row.push_back(fixed(100 * convergence->overshoot, 2));
    for (const double value : {convergence->steady_mean, convergence->steady_rms, convergence->steady_max})
      row.push_back(fixed(value / text.scale, 3));
    rows.push_back(std::move(row));
  }
  if (rows.size() == 1) return "";
  return fmt::format("{}\n", tableText(rows));
}

std::string robotTable(const ServoExperiment& experiment, const ServoResult& result) {
  std::vector<std::vector<std::string>> rows{
      {"robot", "limit margin, deg", "smallest singular value", "frames at limit", "too fast", "damped", "lost", "path, mm"}};
  for (std::size_t r = 0; r < result.runs.size(); ++r) {
    const ServoRobotUse& robot = result.runs[r].robot;
    std::vector<std::string> row{experiment.runs[r].name, fixed(robot.limit_margin / kRadPerDegree, 1),
                                 fixed(robot.smallest_singular_value, 3)};
    for (const int count : robot.num_frames) row.push_back(std::to_string(count));
    row.push_back(fixed(robot.path_length * 1e3, 2));
    rows.push_back(std::move(row));
  }
  return fmt::format("{}\n", tableText(rows));
}

std::string sweepTable(const ServoSweep& sweep, const ServoSweepResult& result) {
  std::vector<std::vector<std::string>> rows{{"gain x period", "growth per period", "theory", ""}};
  for (std::size_t k = 0; k < sweep.gains.size(); ++k) {
    rows.push_back({roundedText(sweep.gains[k]), fixed(result.growth[k], 4), fixed(result.expected_growth[k], 4),
                    result.growth[k] < 1 ? "stable" : "diverges"});
  }
  return fmt::format("{}: stable up to {}, theory {}\n{}\n", sweep.name, fixed(result.limit, 4), fixed(result.expected_limit, 0),
                     tableText(rows));
}

nlohmann::ordered_json asJson(const ServoConvergence& convergence) {
  return {{"feature", textOf(convergence.feature).name},
          {"settling_time", convergence.settling_time},
          {"overshoot", convergence.overshoot},
          {"steady_mean", convergence.steady_mean},
          {"steady_rms", convergence.steady_rms},
          {"steady_max", convergence.steady_max},
          {"error", convergence.error}};
}

nlohmann::ordered_json asJson(const ServoTrace& trace) {
  nlohmann::ordered_json json{{"time", trace.time},
                              {"true_angle", trace.true_angle},
                              {"edge_angle", trace.edge_angle},
                              {"total_force", trace.total_force},
                              {"center_of_pressure", trace.center_of_pressure}};
  for (const auto& [name, poses] : {std::pair{"sensor", &trace.X_WS}, std::pair{"object", &trace.X_WO}}) {
    nlohmann::ordered_json positions = nlohmann::ordered_json::array(), rotations = nlohmann::ordered_json::array();
    for (const Pose& pose : *poses) {
      positions.push_back(pose.position);
      rotations.push_back(pose.rotation);
    }
    json[std::string(name) + "_position"] = std::move(positions);
    json[std::string(name) + "_rotation"] = std::move(rotations);
  }
  const std::size_t num_joints = trace.joint_positions.size() / trace.time.size();
  nlohmann::ordered_json joints = nlohmann::ordered_json::array();
  for (std::size_t n = 0; n < trace.time.size() && num_joints > 0; ++n) {
    const auto first = trace.joint_positions.begin() + static_cast<std::ptrdiff_t>(n * num_joints);
    joints.push_back(std::vector<double>(first, first + static_cast<std::ptrdiff_t>(num_joints)));
  }
  json["joint_positions"] = std::move(joints);
  json["robot_status"] = trace.robot_status;
  return json;
}

nlohmann::ordered_json asJson(const ServoRun& run, const ServoRunResult& result) {
  const ServoRobotUse& robot = result.robot;
  nlohmann::ordered_json json{{"run", run.name},
                              {"group", run.group},
                              {"controller", run.scene.controllers.front().name},
                              {"object", run.scene.objects.front().object.name}};
  json["features"] = nlohmann::ordered_json::array();
  for (const ServoConvergence& convergence : result.convergence) json["features"].push_back(asJson(convergence));
  json["robot"] = {{"limit_margin", robot.limit_margin},
                   {"smallest_singular_value", robot.smallest_singular_value},
                   {"num_frames_at_limit", robot.num_frames[0]},
                   {"num_frames_too_fast", robot.num_frames[1]},
                   {"num_frames_damped", robot.num_frames[2]},
                   {"num_frames_lost", robot.num_frames[3]},
                   {"path_length", robot.path_length}};
  if (!result.expected_error.empty()) {
    json["theory"] = {{"settling_time", result.expected_settling_time},
                      {"largest_deviation", result.largest_deviation},
                      {"error", result.expected_error}};
  }
  if (!result.characteristic.error.empty()) {
    json["characteristic"] = {{"error", result.characteristic.error}, {"measured", result.characteristic.measured}};
  }
  json["frames"] = asJson(result.trace);
  return json;
}

}  // namespace

const ServoConvergence* convergenceOf(const ServoRunResult& run, ServoFeature feature) {
  const auto found =
      std::find_if(run.convergence.begin(), run.convergence.end(), [&](const ServoConvergence& c) { return c.feature == feature; });
  return found == run.convergence.end() ? nullptr : &*found;
}

std::string servoTables(const ServoExperiment& experiment, const ServoResult& result) {
  std::string text = fmt::format(
      "{}: settling = stays within {:g} % of the start error; overshoot in % of the start error; mean, rms and max of the last {:g} s\n\n",
      experiment.name, 100 * experiment.band, experiment.steady);
  for (const ServoFeature feature :
       {ServoFeature::kEdgeAngle, ServoFeature::kTotalForce, ServoFeature::kCenterAcross, ServoFeature::kCenterX, ServoFeature::kCenterY}) {
    text += featureTable(experiment, result, feature);
  }
  text += robotTable(experiment, result);
  for (std::size_t s = 0; s < result.sweeps.size(); ++s) text += sweepTable(experiment.sweeps[s], result.sweeps[s]);
  return text;
}

nlohmann::ordered_json servoJson(const ServoExperiment& experiment, const ServoResult& result) {
  nlohmann::ordered_json json{{"experiment", experiment.name}, {"band", experiment.band}, {"steady", experiment.steady}};
  json["runs"] = nlohmann::ordered_json::array();
  for (std::size_t r = 0; r < result.runs.size(); ++r) json["runs"].push_back(asJson(experiment.runs[r], result.runs[r]));
  json["sweeps"] = nlohmann::ordered_json::array();
  for (std::size_t s = 0; s < result.sweeps.size(); ++s) {
    json["sweeps"].push_back({{"sweep", experiment.sweeps[s].name},
                              {"limit", result.sweeps[s].limit},
                              {"expected_limit", result.sweeps[s].expected_limit},
                              {"gains", experiment.sweeps[s].gains},
                              {"growth", result.sweeps[s].growth},
                              {"expected_growth", result.sweeps[s].expected_growth}});
  }
  return json;
}

}  // namespace taxelsim::figures
