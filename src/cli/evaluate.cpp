// `taxelsim evaluate`: evaluates controllers on a scene's task.
#include "taxelsim/evaluate.h"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <utility>

#include "base/files.h"
#include "cli/activity.h"
#include "cli/commands.h"
#include "cli/evaluate_grasp.h"
#include "cli/evaluation_parts.h"
#include "cli/evaluation_report.h"
#include "cli/interrupt.h"
#include "cli/print.h"
#include "cli/progress.h"
#include "cli/scene_options.h"
#include "cli/worker_options.h"
#include "figures/text.h"
#include "taxelsim/error.h"
#include "workers/evaluate_together.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

struct EvaluateArguments : SceneOptions, PartOptions, WorkerOptions {
  EvaluationReport report;
  std::vector<std::string> controllers;
  std::vector<double> gains;  // 1/s
};

// Names of the controllers to evaluate.
std::vector<std::string> namesOf(const EvaluateArguments& arguments, const Scene& scene) {
  if (!arguments.controllers.empty()) return arguments.controllers;
  std::vector<std::string> names;
  for (const SceneController& controller : scene.controllers) names.push_back(controller.name);
  return names;
}

int mergeParts(const EvaluateArguments& arguments) {
  const Scene scene = loadScene(arguments.scene, arguments.overrides);
  if (scene.kind == Scene::Kind::kGrasp) throw Error(ErrorKind::kInput, "--merge: a scene of kind grasp has no parts of an evaluation");
  const std::vector<NamedPart> parts = partsIn(arguments.merged, namesOf(arguments, scene));
  reportEvaluations(arguments.report, scene, parts.front().part.device, mergeEvaluationParts(scene, parts));
  return kExitOk;
}

// Calls options.on_evaluation with the controllers that are complete, also if it throws after them.
void evaluateAll(const EvaluateArguments& arguments, const Team& team, const Scene& scene, const EvaluateOptions& options) {
  if (team.num_processes == 1)
    evaluate(team.device, scene, arguments.controllers, options);
  else
    workers::evaluateTogether(team.device, scene, arguments.controllers, options, team.num_processes);
}

// Plays a part and writes it to its file.
int playPart(const EvaluateArguments& arguments, const Team& team, const Scene& scene, const EvaluateOptions& options, Activity& activity) {
  const std::filesystem::path file = partFile(arguments.directory, *options.episodes);
  const std::vector<std::string> names = namesOf(arguments, scene);
  const bool is_played = isPlayed(file, scene, deviceText(team.device.info()), names);
  if (!is_played) {
    const EvaluationPart part = workers::evaluatePartTogether(team.device, scene, arguments.controllers, options, team.num_processes);
    activity.end();
    if (*options.stop) {
      spdlog::warn("stopped: {} of {} controllers were evaluated, nothing is written", part.evaluations.size(), names.size());
      return kExitInterrupted;
    }
    createDirectories(arguments.directory);
    writeEvaluationPart(file, part);
  }
  activity.end();
  printOut("{}: {} episodes per controller{}; `taxelsim evaluate --merge {}` puts the parts together\n", file.string(),
           countText(options.episodes->size()), is_played ? " found on disk" : "", arguments.directory);
  return kExitOk;
}

int runGrasp(const EvaluateArguments& arguments, const Scene& scene) {
  const auto refuse = [](bool given, const std::string& what) {
    if (given) throw Error(ErrorKind::kInput, what + ": a scene of kind grasp is evaluated by one process, and has no controllers; --gain");
  };
  refuse(!arguments.controllers.empty(), "--controller");
  refuse(!arguments.episodes.empty(), "--episode-range");
  refuse(!arguments.part.empty(), "--part");
  refuse(arguments.num_workers.value_or(1) > 1, "--workers " + std::to_string(arguments.num_workers.value_or(1)));
  return evaluateGraspScene(arguments, scene, arguments.gains, arguments.report);
}

int runEvaluate(const EvaluateArguments& arguments) {
  if (!arguments.merged.empty()) return mergeParts(arguments);
  const Scene scene = loadSceneOf(arguments, arguments.role.empty());
  if (scene.kind == Scene::Kind::kGrasp) return runGrasp(arguments, scene);
  if (!arguments.gains.empty())
    throw Error(ErrorKind::kInput, "--gain is for scenes of kind grasp: the controllers of this scene have their gains");
  EvaluateOptions options;
  options.episodes = chosenEpisodes(arguments, scene.num_episodes);
  if (options.episodes && options.episodes->size() == 0) {
    printOut("{}: part {} of {} episodes is empty\n", arguments.directory, arguments.part, countText(scene.num_episodes));
    return kExitOk;
  }
  options.batch_size = arguments.batch_size;
  const std::uint64_t num_episodes = options.episodes ? options.episodes->size() : scene.num_episodes;
  const Team team = openTeam(arguments, arguments, num_episodes, [&](int num_requested) {
    return static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(num_requested), num_episodes));
  });
  if (team.number > 1)
    return workers::evaluateAsWorker(team.device, scene, arguments.controllers, options, team.number, team.num_processes);
  Activity activity("preparing the simulation");
  ProgressPrinter printer;
  options.stop = &stopOnSignals();
  bool announced = false;
  options.on_progress = [&](const Progress& progress) {
    if (!std::exchange(announced, true)) {
      activity.end();
      spdlog::info("{}: {} episodes per controller on {} ({})", sceneTitle(scene), countText(num_episodes), team.device.info().name,
                   team.device.info().driver);
    }
    printer.show(progress);
  };
  if (options.episodes) return playPart(arguments, team, scene, options, activity);
  std::vector<Evaluation> evaluations;
  const std::size_t num_controllers = namesOf(arguments, scene).size();
  options.on_evaluation = [&](const Evaluation& evaluation) {
    evaluations.push_back(evaluation);
    if (num_controllers > 1) spdlog::info("controller {} evaluated ({} of {})", evaluation.controller, evaluations.size(), num_controllers);
  };
  const auto report = [&] {
    activity.end();
    printer.clear();
    if (!evaluations.empty()) reportEvaluations(arguments.report, scene, deviceText(team.device.info()), evaluations);
  };
  try {
    evaluateAll(arguments, team, scene, options);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::kDevice) report();  // what was evaluated before the device was lost
    throw;
  }
  const bool stopped = *options.stop;
  report();
  if (!stopped) return kExitOk;
  spdlog::warn("stopped: {} of {} controllers are evaluated", evaluations.size(), num_controllers);
  return kExitInterrupted;
}

}  // namespace

void addEvaluate(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("evaluate", "Evaluate controllers on a scene's task, same episodes for each");
  command->footer(
      "Examples:\n  taxelsim evaluate scenes/tasks/align_edge.yaml --episodes 10000\n"
      "  taxelsim evaluate scenes/benchmark/edge_align.yaml --policy p.onnx --controller window\n"
      "  taxelsim evaluate scenes/shadow_grasp.yaml --gain 5 --gain 10 --gain 20\n"
      "Scored on ground truth, not on sensor readings. Results do not depend on the batch size. Ctrl-C keeps the controllers that are\n"
      "complete.\n"
      "On several machines of one kind, which share out/, K = 1 to 16:\n"
      "  taxelsim evaluate scenes/tasks/align_edge.yaml --episodes 1000000 --part K/16 -o out/\n"
      "  taxelsim evaluate scenes/tasks/align_edge.yaml --episodes 1000000 --merge out/\n"
      "--policy FILE evaluates an ONNX policy in Python; `python3 -m taxelsim evaluate --policy FILE --help` lists its options.");
  const auto arguments = std::make_shared<EvaluateArguments>();
  addSceneOptions(*command, *arguments, EvaluateOptions{}.batch_size);
  command->add_option("--controller", arguments->controllers, "Name of a controller of the scene; may be repeated. Default: all")
      ->type_name("NAME");
  command
      ->add_option("--gain", arguments->gains,
                   "Of a scene of kind grasp, 1/s: gain of the fingers; may be repeated. Default: that of the scene")
      ->type_name("GAIN");
  addPartOptions(*command, *arguments);
  addWorkerOptions(*command, *arguments);
  command->get_option("--workers")->excludes("--merge");
  command->add_option("--png", arguments->report.png, "Figure to write (PNG): settling, errors and success by start error")
      ->check(requirePngName)
      ->type_name("FILE");
  command->add_flag("--json", arguments->report.json, "Print JSON with every episode");
  command->callback([=, &action] { action = [=] { return runEvaluate(*arguments); }; });
}

}  // namespace taxelsim::cli
