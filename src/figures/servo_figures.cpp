#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include "base/constants.h"
#include "figures/line_chart.h"
#include "figures/servo_report.h"
#include "figures/tactile_figure.h"
#include "figures/taxel_chart.h"
#include "taxelsim/error.h"

namespace taxelsim::figures {
namespace {

constexpr double kMilli = 1e-3;
constexpr double kNear = 2.5;  // half height of the plots near the reference, in bands
constexpr const char* kTimeLabel = "time, s";

std::vector<double> scaled(const std::vector<double>& values, double unit, double offset = 0) {
  std::vector<double> result;
  for (const double value : values) result.push_back(value / unit + offset);
  return result;
}

double angleReference(const ServoRun& run) {
  return run.scene.controllers.front().servo[ServoFeature::kEdgeAngle].reference.value_or(0);
}

// Frame numbers of the paper's phases: I start, II half of the start error, III end.
std::array<std::size_t, 3> phasesOf(const ServoRunResult& run) {
  const std::size_t last = run.trace.time.size() - 1;
  const ServoConvergence* angle = convergenceOf(run, ServoFeature::kEdgeAngle);
  if (angle == nullptr) return {0, last / 2, last};
  std::size_t midway = 0;
  while (midway < last && std::abs(angle->error[midway]) > std::abs(angle->error.front()) / 2) ++midway;
  return {0, midway, last};
}

constexpr std::array<const char*, 3> kPhases = {"I", "II", "III"};

std::string fileName(const std::string& run) {
  std::string name;
  for (const char c : run) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (plain || (!name.empty() && name.back() != '_')) name += plain ? c : '_';
  }
  return name + ".png";
}

// Calls function(group, indices of its runs) for each group, in order of appearance.
template <typename Function>
void eachGroup(const ServoExperiment& experiment, Function function) {
  std::vector<std::string> done;
  for (const ServoRun& run : experiment.runs) {
    if (std::find(done.begin(), done.end(), run.group) != done.end()) continue;
    done.push_back(run.group);
    std::vector<std::size_t> members;
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
      if (experiment.runs[r].group == run.group) members.push_back(r);
    }
    function(run.group, members);
  }
}

void drawAngles(const std::filesystem::path& file, const ServoExperiment& experiment, const ServoResult& result) {
  std::vector<LinePanel> panels;
  eachGroup(experiment, [&](const std::string& group, const std::vector<std::size_t>& members) {
    LinePanel panel{.title = group, .x_label = kTimeLabel, .y_label = "edge angle, degrees", .series = {}};
    bool has_theory = false;
    for (const std::size_t r : members) {
      const ServoRunResult& run = result.runs[r];
      const ServoConvergence* angle = convergenceOf(run, ServoFeature::kEdgeAngle);
      if (angle == nullptr) continue;
      const double reference = angleReference(experiment.runs[r]) / kRadPerDegree;
      panel.reference = LineLevel{.y = reference, .name = "reference"};
      panel.series.push_back({.name = experiment.runs[r].name, .x = run.trace.time, .y = scaled(angle->error, kRadPerDegree, reference)});
    }
    // Theory is dashed on top of the curves, so that both are visible where they agree.
    for (const std::size_t r : members) {
      const ServoRunResult& run = result.runs[r];
      if (run.expected_error.empty()) continue;
      panel.series.push_back({.name = has_theory ? "" : "theory",
                              .x = run.trace.time,
                              .y = scaled(run.expected_error, kRadPerDegree, angleReference(experiment.runs[r]) / kRadPerDegree),
                              .style = LineStyle::kDashed,
                              .colour = kInk});
      has_theory = true;
    }
    LinePanel near = panel;
    if (members.size() == 1) {
      const std::array<std::size_t, 3> phases = phasesOf(result.runs[members.front()]);
      for (std::size_t k = 0; k < phases.size(); ++k) {
        panel.marks.push_back({result.runs[members.front()].trace.time[phases[k]], kPhases[k]});
      }
    }
    panels.push_back(std::move(panel));
    if (!near.reference) return;
    const double start = std::abs(convergenceOf(result.runs[members.front()], ServoFeature::kEdgeAngle)->error.front()) / kRadPerDegree;
    const double reference = near.reference->y, half = experiment.band * start;
    near.title += ", near the reference";
    near.band = LineBand{reference - half, reference + half, fmt::format("{:g} % of the start error", 100 * experiment.band)};
    const auto is_near = [&](double angle) { return std::abs(angle - reference) < kNear * half; };
    const bool any_near = std::any_of(near.series.begin(), near.series.end(),
                                      [&](const LineSeries& series) { return std::any_of(series.y.begin(), series.y.end(), is_near); });
    near.y_range = {reference - kNear * half, reference + kNear * half};
    if (any_near) panels.push_back(std::move(near));
  });
  writeLineChart(file, panels, {.title = experiment.name + ": edge angle", .subtitle = "true edge angle in the plane of the sensor"});
}

// Each of the next three returns false, without a figure, if there is nothing to draw.
bool drawFeatures(const std::filesystem::path& file, const ServoExperiment& experiment, const ServoResult& result) {
  struct Drawn {
    ServoFeature feature;
    const char* title;
    const char* label;
    double unit;
  };
  std::vector<LinePanel> panels;
  for (const Drawn& drawn : {Drawn{ServoFeature::kTotalForce, "force", "total force - reference, N", 1},
                             Drawn{ServoFeature::kCenterAcross, "centre across the edge", "centre - reference, mm", kMilli},
                             Drawn{ServoFeature::kCenterX, "centre along x of the sensor", "centre - reference, mm", kMilli},
                             Drawn{ServoFeature::kCenterY, "centre along y of the sensor", "centre - reference, mm", kMilli}}) {
    LinePanel panel{.title = drawn.title,
                    .x_label = kTimeLabel,
                    .y_label = drawn.label,
                    .series = {},
                    .reference = LineLevel{.y = 0, .name = "reference"}};
    for (std::size_t r = 0; r < result.runs.size(); ++r) {
      const ServoConvergence* convergence = convergenceOf(result.runs[r], drawn.feature);
      if (convergence == nullptr) continue;
      panel.series.push_back(
          {.name = experiment.runs[r].name, .x = result.runs[r].trace.time, .y = scaled(convergence->error, drawn.unit)});
    }
    if (!panel.series.empty()) panels.push_back(std::move(panel));
  }
  if (panels.empty()) return false;
  writeLineChart(file, panels,
                 {.title = experiment.name + ": force and centre", .subtitle = "features of ground truth, before readout and noise"});
  return true;
}

LinePanel jointPanel(const ServoRun& run, const ServoTrace& trace, const Manipulator& robot) {
  LinePanel panel{.title = run.name + ": joints", .x_label = kTimeLabel, .y_label = "from the start, degrees", .series = {}};
  const std::size_t num_joints = robot.joints.size();
  for (std::size_t j = 0; j < num_joints; ++j) {
    const bool turns = robot.joints[j].type == JointType::kRevolute;
    LineSeries series{.name = robot.joints[j].name + (turns ? "" : ", mm"), .x = trace.time, .y = {}};
    for (std::size_t n = 0; n < trace.time.size(); ++n) {
      series.y.push_back((trace.joint_positions[n * num_joints + j] - trace.joint_positions[j]) / (turns ? kRadPerDegree : kMilli));
    }
    panel.series.push_back(std::move(series));
  }
  return panel;
}

LineSeries pathOf(const std::string& name, const std::vector<Pose>& poses) {
  LineSeries series{.name = name, .x = {}, .y = {}};
  for (const Pose& pose : poses) {
    series.x.push_back((pose.position[0] - poses.front().position[0]) / kMilli);
    series.y.push_back((pose.position[1] - poses.front().position[1]) / kMilli);
  }
  return series;
}

bool drawRobots(const std::filesystem::path& file, const ServoExperiment& experiment, const ServoResult& result) {
  std::vector<LinePanel> panels;
  bool any_path = false;
  for (std::size_t r = 0; r < result.runs.size(); ++r) {
    const ServoRun& run = experiment.runs[r];
    const ServoTrace& trace = result.runs[r].trace;
    const auto* manipulator = std::get_if<Manipulator>(&run.scene.robot);
    if (manipulator == nullptr) continue;
    panels.push_back(jointPanel(run, trace, *manipulator));
    // No path for a platform that only rotates its sensor.
    constexpr double kLeastPath = 1e-4;  // m
    if (result.runs[r].robot.path_length < kLeastPath) continue;
    any_path = true;
    LinePanel path{.title = run.name + ": path",
                   .x_label = "x, mm",
                   .y_label = "y, mm",
                   .series = {pathOf("sensor", trace.X_WS), pathOf("object", trace.X_WO)},
                   .equal_axes = true};
    path.series.push_back({.name = "end", .x = {path.series[0].x.back()}, .y = {path.series[0].y.back()}, .style = LineStyle::kPoints});
    if (!run.scene.objects.front().motion) path.series.erase(path.series.begin() + 1);
    panels.push_back(std::move(path));
  }
  if (panels.empty()) return false;
  writeLineChart(file, panels,
                 {.title = experiment.name + ": robot", .subtitle = any_path ? "paths in the plane of the skin at the start" : ""});
  return true;
}

bool drawTheory(const std::filesystem::path& file, const ServoExperiment& experiment, const ServoResult& result) {
  std::vector<LinePanel> panels;
  for (std::size_t r = 0; r < result.runs.size(); ++r) {
    const StaticCharacteristic& read = result.runs[r].characteristic;
    if (read.error.empty()) continue;
    std::vector<double> off;
    for (std::size_t k = 0; k < read.error.size(); ++k) {
      off.push_back(std::remainder(read.measured[k] - read.error[k], std::numbers::pi) / kRadPerDegree);
    }
    panels.push_back({.title = experiment.runs[r].name + ": static characteristic of the edge angle",
                      .x_label = "true angle - reference, degrees",
                      .y_label = "measured - true angle, degrees",
                      .series = {{.name = "sensor", .x = scaled(read.error, kRadPerDegree), .y = std::move(off)}},
                      .reference = LineLevel{.y = 0, .name = "no error"}});
  }
  for (std::size_t s = 0; s < result.sweeps.size(); ++s) {
    const ServoSweep& sweep = experiment.sweeps[s];
    panels.push_back(
        {.title = fmt::format("{}: stable up to {:.3f}, theory {:g}", sweep.name, result.sweeps[s].limit, result.sweeps[s].expected_limit),
         .x_label = "gain x control period",
         .y_label = "growth of the error per period",
         .series =
             {{.name = "theory", .x = sweep.gains, .y = result.sweeps[s].expected_growth, .style = LineStyle::kDashed, .colour = kInk},
              {.name = "measured", .x = sweep.gains, .y = result.sweeps[s].growth, .style = LineStyle::kPoints}},
         .reference = LineLevel{.y = 1, .name = "stable below"}});
  }
  if (panels.empty()) return false;
  writeLineChart(file, panels,
                 {.title = experiment.name + ": theory",
                  .subtitle = "static characteristic of the sensor, and growth of the error near the stability limit"});
  return true;
}

// Figures 11 b and 12 b of the paper: true and reference edge on the tactile image.
void drawImages(const std::filesystem::path& file, const ServoRun& run, const ServoRunResult& result) {
  const Sensor& sensor = run.scene.sensor;
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  const std::array<std::size_t, 3> phases = phasesOf(result);
  std::vector<TactilePanel> panels;
  for (std::size_t k = 0; k < phases.size(); ++k) {
    const std::size_t n = phases[k];
    TactilePanel panel;
    panel.outlines = outlinesOf(sensor);
    panel.neighbours = false;
    panel.numbers = false;  // would hide the lines
    const auto first = result.trace.tactile_image.begin() + static_cast<std::ptrdiff_t>(n * num_taxels);
    panel.values.assign(first, first + static_cast<std::ptrdiff_t>(num_taxels));
    panel.title = fmt::format("{}: {:.2f} s", kPhases[k], result.trace.time[n]);
    const Vector3& center = result.trace.center_of_pressure[n];
    if (const ServoConvergence* angle = convergenceOf(result, ServoFeature::kEdgeAngle)) {
      const double reference = angleReference(run);
      panel.lines = {{.through = {center[0], center[1]}, .angle = reference, .colour = kGreen, .name = "reference edge"},
                     {.through = {center[0], center[1]}, .angle = reference + angle->error[n], .colour = kRed, .name = "true edge"}};
      panel.caption = fmt::format("{:.1f}° from the reference, {:.2f} N", angle->error[n] / kRadPerDegree, result.trace.total_force[n]);
    }
    panels.push_back(std::move(panel));
  }
  writeTactileFigure(file, panels, {.title = run.name, .subtitle = "tactile_image, counts", .num_columns = 3});
}

}  // namespace

std::size_t drawServoFigures(const std::filesystem::path& directory, const ServoExperiment& experiment, const ServoResult& result) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  drawAngles(directory / "angle.png", experiment, result);
  std::size_t num_figures = 1 + result.runs.size();
  num_figures += drawFeatures(directory / "features.png", experiment, result) ? 1 : 0;
  num_figures += drawRobots(directory / "robot.png", experiment, result) ? 1 : 0;
  num_figures += drawTheory(directory / "theory.png", experiment, result) ? 1 : 0;
  for (std::size_t r = 0; r < result.runs.size(); ++r) {
    drawImages(directory / fileName(experiment.runs[r].name), experiment.runs[r], result.runs[r]);
  }
  return num_figures;
}

}  // namespace taxelsim::figures
