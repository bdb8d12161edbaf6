// `taxelsim experiment`: the paper's experiments. Compares sensor models under static loads and under the pin of a calibration, and servo
// loops with theory.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "cli/activity.h"
#include "cli/commands.h"
#include "cli/driver_threads.h"
#include "cli/print.h"
#include "cli/scene_options.h"
#include "figures/calibration_report.h"
#include "figures/cross_validation_text.h"
#include "figures/grasp_report.h"
#include "figures/servo_report.h"
#include "figures/tactile_figure.h"
#include "figures/taxel_chart.h"
#include "sensor/fields.h"
#include "taxelsim/cross_validate.h"
#include "taxelsim/device.h"
#include "taxelsim/error.h"
#include "taxelsim/experiment.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

struct ExperimentArguments {
  std::string file, directory, device;
  bool json = false;
  bool validation = false;
};

std::size_t numberOf(const StaticExperiment& experiment, std::size_t object, std::size_t yaw, std::size_t load) {
  return (object * experiment.yaw.size() + yaw) * experiment.loads.size() + load;
}

std::string fitText(const StaticImages& images) {
  if (images.fitted_sigma == 0) return "";
  return fmt::format("normal_contact_stiffness {:.4g} N/m^3, psf sigma {:.3f} taxels",
                     std::get<Winkler>(images.sensor.skin.law).normal_contact_stiffness, images.fitted_sigma);
}

void printTable(const StaticExperiment& experiment, const StaticResult& result) {
  std::string scored;
  std::size_t num_scored = 0;
  for (std::size_t object = 0; object < experiment.objects.size(); ++object) {
    if (!isScored(experiment, object)) continue;
    scored += (num_scored++ > 0 ? ", " : "") + experiment.objects[object].object.name;
  }
  printOut("{}: {} indenters x {} angles. Reference: images of {}, simulated by the law {}\n", experiment.name, experiment.objects.size(),
           experiment.yaw.size(), result.reference.name, kLawNames[result.reference.sensor.skin.law.index()]);
  printOut(
      "These numbers compare models with each other, not with a real sensor. The paper reports a median difference of about 5 % between\n"
      "simulated and real images.\n"
      "M1: median |difference| over taxels with force, % of full scale; M4: sum |difference| / sum of reference, %; medians over the\n"
      "contacts of {}{}\n\n",
      scored, num_scored < experiment.objects.size() ? "; the other indenters are those of the fit" : "");
  std::string heading = fmt::format("{:<32}", "sensor");
  for (const double load : experiment.loads)
    heading += fmt::format("  {:>8}  {:>8}", fmt::format("M1 {:.3g}N", load), fmt::format("M4 {:.3g}N", load));
  printOut("{}\n", heading);
  std::vector<const StaticImages*> rows;
  for (const StaticImages& images : result.sensors) rows.push_back(&images);
  for (const StaticImages& images : result.baselines) rows.push_back(&images);
  for (const StaticImages* row : rows) {
    const StaticImages& images = *row;
    std::string line = fmt::format("{:<32}", images.name);
    for (std::size_t load = 0; load < experiment.loads.size(); ++load) {
      const ImageDistance distance = medianDistance(experiment, images, load);
      line += fmt::format("  {:>8.2f}  {:>8.1f}", 100 * distance.median_difference, 100 * distance.relative_l1);
    }
    printOut("{}\n", line);
  }
  for (const StaticImages& images : result.sensors) {
    if (images.fitted_sigma > 0) printOut("\n{}: {}\n", images.name, fitText(images));
  }
}

nlohmann::ordered_json mediansJson(const StaticExperiment& experiment, const StaticImages& images) {
  nlohmann::ordered_json medians = nlohmann::ordered_json::array();
  for (std::size_t load = 0; load < experiment.loads.size(); ++load) {
    const ImageDistance distance = medianDistance(experiment, images, load);
    medians.push_back(
        {{"load", experiment.loads[load]}, {"median_difference", distance.median_difference}, {"relative_l1", distance.relative_l1}});
  }
  return medians;
}

nlohmann::ordered_json asJson(const StaticExperiment& experiment, const StaticImages& images) {
  nlohmann::ordered_json json{{"sensor", images.name}};
  if (images.fitted_sigma > 0) {
    json["normal_contact_stiffness"] = std::get<Winkler>(images.sensor.skin.law).normal_contact_stiffness;
    json["psf_sigma"] = images.fitted_sigma;
  }
  json["medians"] = mediansJson(experiment, images);
  nlohmann::ordered_json& contacts = json["contacts"] = nlohmann::ordered_json::array();
  for (std::size_t object = 0; object < experiment.objects.size(); ++object) {
    for (std::size_t yaw = 0; yaw < experiment.yaw.size(); ++yaw) {
      for (std::size_t load = 0; load < experiment.loads.size(); ++load) {
        const std::size_t contact = numberOf(experiment, object, yaw, load);
        contacts.push_back({{"object", experiment.objects[object].object.name},
                            {"yaw", experiment.yaw[yaw]},
                            {"load", experiment.loads[load]},
                            {"scored", isScored(experiment, object)},
                            {"median_difference", images.distances[contact].median_difference},
                            {"relative_l1", images.distances[contact].relative_l1},
                            {"tactile_normal_force", images.images[contact]}});
      }
    }
  }
  return json;
}

TactilePanel panelOf(const StaticImages& images, std::size_t contact) {
  const GridPatch& patch = images.sensor.patches.front();
  TactilePanel panel;
  panel.num_rows = patch.num_rows;
  panel.num_cols = patch.num_cols;
  panel.pitch = patch.pitch;
  if (isTaxelList(images.sensor)) {
    panel.outlines = unrolled(images.sensor);
    panel.neighbours = false;
  }
  panel.values.assign(images.images[contact].begin(), images.images[contact].end());
  for (double& value : panel.values) value = std::round(value * 1000) / 1000;  // mN: a cell has no room for more digits
  if (panel.outlines.empty()) panel.axes = axesOfImage(panel);
  return panel;
}

// Figures 8 and 9 of the paper: one figure per indenter and load, one row per angle, the reference first. Returns their number.
std::size_t drawFigures(const std::string& directory, const StaticExperiment& experiment, const StaticResult& result) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  std::vector<const StaticImages*> all{&result.reference};
  for (const StaticImages& images : result.sensors) all.push_back(&images);
  for (const StaticImages* images : all) {
    if (images->sensor.patches.size() != 1 && !isTaxelList(images->sensor)) return 0;
  }
  for (std::size_t object = 0; object < experiment.objects.size(); ++object) {
    for (std::size_t load = 0; load < experiment.loads.size(); ++load) {
      std::vector<TactilePanel> panels;
      for (std::size_t yaw = 0; yaw < experiment.yaw.size(); ++yaw) {
        const std::size_t contact = numberOf(experiment, object, yaw, load);
        for (const StaticImages* images : all) {
          TactilePanel panel = panelOf(*images, contact);
          panel.title = fmt::format("{}, {:.0f}°", images->name, experiment.yaw[yaw] * 180 / std::numbers::pi);
          const ImageDistance& distance = images->distances[contact];
          panel.caption = images == &result.reference
                              ? "reference"
                              : fmt::format("M1 {:.2f} %   M4 {:.1f} %", 100 * distance.median_difference, 100 * distance.relative_l1);
          panels.push_back(std::move(panel));
        }
      }
      const std::string& name = experiment.objects[object].object.name;
      writeTactileFigure(std::filesystem::path(directory) / fmt::format("{}_{:.3g}N.png", name, experiment.loads[load]), panels,
                         {.title = fmt::format("{} under {:.3g} N", name, experiment.loads[load]),
                          .subtitle = "tactile_normal_force, before readout and noise",
                          .unit = "N",
                          .num_columns = static_cast<int>(all.size())});
    }
  }
  return experiment.objects.size() * experiment.loads.size();
}

nlohmann::ordered_json asJson(const StaticExperiment& experiment, const StaticResult& result) {
  nlohmann::ordered_json json{{"experiment", experiment.name}, {"reference", asJson(experiment, result.reference)}};
  json["baselines"] = nlohmann::ordered_json::array();
  for (const StaticImages& images : result.baselines) {
    json["baselines"].push_back({{"name", images.name}, {"medians", mediansJson(experiment, images)}});
  }
  json["sensors"] = nlohmann::ordered_json::array();
  for (const StaticImages& images : result.sensors) json["sensors"].push_back(asJson(experiment, images));
  return json;
}

void report(const ExperimentArguments& arguments, const Device& device, const StaticExperiment& experiment) {
  Activity activity("running " + experiment.name);
  const StaticResult result = runStaticExperiment(device, experiment);
  activity.end();
  if (arguments.json) {
    printJsonText(asJson(experiment, result));
  } else {
    printTable(experiment, result);
  }
  if (arguments.directory.empty()) return;
  const std::size_t num_figures = drawFigures(arguments.directory, experiment, result);
  if (num_figures > 0) {
    spdlog::info("wrote {} figures to {}", num_figures, arguments.directory);
  } else {
    spdlog::warn("no figures: a sensor with several grids cannot be drawn");
  }
}

void report(const ExperimentArguments& arguments, const Device& device, const ServoExperiment& experiment) {
  Activity activity("running " + experiment.name);
  const ServoResult result = runServoExperiment(device, experiment);
  activity.end();
  if (arguments.json) {
    printJsonText(servoJson(experiment, result), -1);
  } else {
    printOut("{}", servoTables(experiment, result));
  }
  if (arguments.directory.empty()) return;
  const std::size_t num_figures = drawServoFigures(arguments.directory, experiment, result);
  spdlog::info("wrote {} figures to {}", num_figures, arguments.directory);
}

void report(const ExperimentArguments& arguments, const Device& device, const CalibrationExperiment& experiment) {
  Activity activity("running " + experiment.name);
  const std::vector<CalibrationCurves> sensors = runCalibrationExperiment(device, experiment);
  activity.end();
  if (arguments.json) {
    printJsonText(calibrationJson(experiment, sensors), -1);
  } else {
    printOut("{}", calibrationTables(experiment, sensors));
  }
  if (arguments.directory.empty()) return;
  drawCalibration(arguments.directory, experiment, sensors);
  spdlog::info("wrote 1 figure to {}", arguments.directory);
}

void report(const ExperimentArguments& arguments, const Device& device, const GraspExperiment& experiment) {
  Activity activity("running " + experiment.name);
  const std::vector<GraspRun> runs = runGraspExperiment(device, experiment);
  activity.end();
  if (arguments.json) {
    printJsonText(graspJson(experiment, runs), -1);
  } else {
    printOut("{}", graspTable(experiment, runs));
  }
  if (arguments.directory.empty()) return;
  drawGrasp(arguments.directory, experiment, runs);
  spdlog::info("wrote 1 figure to {}", arguments.directory);
}

// Needs no device.
void report(const ExperimentArguments& arguments, const CharacterizationExperiment& experiment) {
  if (!experiment.missing.empty()) {
    spdlog::warn("{}: skipped, {}", experiment.name, experiment.missing);
    return;
  }
  if (!experiment.skipped.empty()) spdlog::warn("{}: {}", experiment.name, experiment.skipped);
  Activity activity("running " + experiment.name);
  const std::vector<CrossValidation> results = crossValidate(experiment);
  activity.end();
  if (arguments.json) {
    const nlohmann::ordered_json json{{"experiment", experiment.name},
                                      {"cross_validation", crossValidationJson(results, experiment.light_below)}};
    printJsonText(json);
  } else {
    printOut("{}", crossValidationText(results, experiment.light_below));
  }
}

int runExperiment(const ExperimentArguments& arguments) {
  setDriverThreads(1);
  Activity activity("loading " + arguments.file);
  const Experiment experiment = loadExperiment(arguments.file);
  activity.end();
  if (const auto* const recordings = std::get_if<CharacterizationExperiment>(&experiment)) {
    report(arguments, *recordings);
    return kExitOk;
  }
  const Device device = Device::open({.device = arguments.device, .validation = arguments.validation});
  if (const auto* const contacts = std::get_if<StaticExperiment>(&experiment)) report(arguments, device, *contacts);
  if (const auto* const servo = std::get_if<ServoExperiment>(&experiment)) report(arguments, device, *servo);
  if (const auto* const grasp = std::get_if<GraspExperiment>(&experiment)) report(arguments, device, *grasp);
  if (const auto* const calibration = std::get_if<CalibrationExperiment>(&experiment)) report(arguments, device, *calibration);
  return kExitOk;
}

}  // namespace

void addExperiment(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "experiment",
      "Run an experiment: indenters under dead weights, a robot that aligns with an edge, a calibration with a pin, or fingers that close");
  command->footer(
      "Example:\n  taxelsim experiment scenes/experiments/paper/static_indenters.yaml -o figures/\n"
      "  taxelsim experiment scenes/experiments/paper/pan_tilt.yaml -o figures/\n"
      "  taxelsim experiment scenes/experiments/paper/calibration.yaml -o figures/\n"
      "  taxelsim experiment scenes/experiments/gripper_gains.yaml -o figures/\n"
      "Static experiments compare the images of each sensor model, in newtons, with those of a reference model. Servo experiments\n"
      "and grasps compare each run with theory where there is one. Calibrations compare force against depth and counts against force\n"
      "with measured values.");
  const auto arguments = std::make_shared<ExperimentArguments>();
  command->add_option("experiment", arguments->file, "Experiment file (YAML)")->required()->type_name("FILE");
  command->add_option("-o,--output", arguments->directory, "Draw figures into this directory")->type_name("DIR");
  command->add_flag("--json", arguments->json, "Print JSON with all results instead of tables");
  addDeviceOptions(*command, arguments->device, arguments->validation);
  command->callback([=, &action] { action = [=] { return runExperiment(*arguments); }; });
}

}  // namespace taxelsim::cli
