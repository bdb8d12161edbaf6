// `taxelsim evaluate`: evaluates controllers on a scene's task.
#include "taxelsim/evaluate.h"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <utility>

#include "base/files.h"
#include "cli/commands.h"
#include "cli/driver_threads.h"
#include "cli/evaluate_grasp.h"
#include "cli/evaluation_parts.h"
#include "cli/evaluation_report.h"
#include "cli/interrupt.h"
#include "cli/print.h"
#include "cli/processes.h"
#include "cli/run_display.h"
#include "cli/scene_options.h"
#include "episodes/contact_misses.h"
#include "figures/text.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

struct EvaluateArguments : SceneOptions, PartOptions {
  EvaluationReport report;
  std::vector<std::string> controllers;
  std::vector<double> gains;  // 1/s
  int num_processes = 1;
};

// Names of the controllers, or of the gains, to evaluate.
std::vector<std::string> namesOf(const EvaluateArguments& arguments, const Scene& scene) {
  if (scene.grasp) {
    std::vector<std::string> names;
    for (const double gain : arguments.gains.empty() ? std::vector{scene.grasp->gain} : arguments.gains) names.push_back(gainName(gain));
    return names;
  }
  if (!arguments.controllers.empty()) return arguments.controllers;
  std::vector<std::string> names;
  for (const SceneController& controller : scene.controllers) names.push_back(controller.name);
  return names;
}

// Reports the parts together. Returns the number of controllers or gains.
std::size_t reportParts(const EvaluateArguments& arguments, const Scene& scene, const std::vector<NamedPart>& parts) {
  const std::string& device = parts.front().part.device;
  const std::size_t num_evaluations = parts.front().part.evaluations.size();
  if (num_evaluations == 0) return 0;
  if (scene.grasp) {
    reportGrasps(arguments.report, scene, device, mergeGraspParts(scene, parts));
  } else {
    reportEvaluations(arguments.report, scene, device, mergeEvaluationParts(scene, parts));
  }
  return num_evaluations;
}

void checkKind(const EvaluateArguments& arguments, const Scene& scene) {
  if (scene.grasp && !arguments.controllers.empty())
    throw Error(ErrorKind::kInput, "--controller: a scene of kind grasp has no controllers; --gain");
  if (!scene.grasp && !arguments.gains.empty())
    throw Error(ErrorKind::kInput, "--gain is for scenes of kind grasp: the controllers of this scene have their gains");
}

int mergeParts(const EvaluateArguments& arguments) {
  const Scene scene = loadScene(arguments.scene, arguments.overrides);
  checkKind(arguments, scene);
  reportParts(arguments, scene, partsIn(arguments.merged, namesOf(arguments, scene)));
  return kExitOk;
}

// Word for the players of a scene.
const char* playerOf(const Scene& scene) {
  return scene.grasp ? "gain" : "controller";
}

// As `report`, but first logs what is evaluated on which device.
std::function<void(const Progress&)> announced(const Scene& scene, const EpisodeRange& episodes, const Device& device,
                                               const std::function<void(const Progress&)>& report) {
  return [=, title = sceneTitle(scene), player = playerOf(scene), info = device.info(),
          is_announced = false](const Progress& progress) mutable {
    if (!std::exchange(is_announced, true))
      spdlog::info("{}: {} episodes per {} on {} ({})", title, countText(episodes.size()), player, info.name, info.driver);
    report(progress);
  };
}

// Appends the part that follows. Leaves out the controllers that are not complete in both.
void append(EvaluationPart& part, const EvaluationPart& next) {
  part.episodes.end = next.episodes.end;
  part.evaluations.resize(std::min(part.evaluations.size(), next.evaluations.size()));
  for (std::size_t c = 0; c < part.evaluations.size(); ++c) {
    EvaluationPart::Verdicts& sum = part.evaluations[c];
    const EvaluationPart::Verdicts& more = next.evaluations[c];
    sum.verdicts.insert(sum.verdicts.end(), more.verdicts.begin(), more.verdicts.end());
    sum.grasps.insert(sum.grasps.end(), more.grasps.begin(), more.grasps.end());
    for (std::size_t f = 0; f < sum.misses.size(); ++f) add(sum.misses[f], more.misses[f]);
  }
}

// As evaluatePart(), by processes that play a part of the episodes each.
EvaluationPart playRange(const EvaluateArguments& arguments, const Scene& scene, const EpisodeRange& episodes, int num_processes) {
  const std::vector<std::string> results = runProcesses(num_processes, [&](const Process& process) {
    const auto [first, end] =
        partOfEpisodes(episodes.size(), static_cast<std::uint64_t>(process.number) + 1, static_cast<std::uint64_t>(num_processes));
    const EpisodeRange own{.first = episodes.first + first, .end = episodes.first + end};
    const Device device = openDevice(arguments);
    const std::function<void(const Progress&)> report = announced(scene, episodes, device, process.report);
    if (scene.grasp) {
      GraspEvaluateOptions options{.on_progress = report, .stop = &process.stop, .episodes = own};
      options.batch_size = batchShare(std::min(arguments.batch_size, options.batch_size), num_processes);
      return evaluationPartText(evaluateGraspPart(device, scene, arguments.gains, options));
    }
    EvaluateOptions options{.on_progress = report, .stop = &process.stop, .episodes = own};
    options.batch_size = batchShare(arguments.batch_size, num_processes);
    return evaluationPartText(evaluatePart(device, scene, arguments.controllers, options));
  });
  EvaluationPart played = parseEvaluationPart(results.front(), "process 1");
  for (std::size_t p = 1; p < results.size(); ++p) append(played, parseEvaluationPart(results[p], "process " + std::to_string(p + 1)));
  return played;
}

// Plays a part and writes it to its file.
int playPart(const EvaluateArguments& arguments, const Scene& scene, const EpisodeRange& episodes, int num_processes) {
  const std::filesystem::path file = partFile(arguments.directory, episodes);
  const std::vector<std::string> names = namesOf(arguments, scene);
  const bool is_played = std::filesystem::exists(file) && isPlayed(file, scene, deviceText(openDevice(arguments).info()), names);
  if (!is_played) {
    const EvaluationPart part = playRange(arguments, scene, episodes, num_processes);
    if (stopOnSignals()) {
      spdlog::warn("stopped: {} of {} {}s were evaluated, nothing is written", part.evaluations.size(), names.size(), playerOf(scene));
      return kExitInterrupted;
    }
    createDirectories(arguments.directory);
    writeEvaluationPart(file, part);
  }
  printOut("{}: {} episodes per {}{}; `taxelsim evaluate --merge {}` puts the parts together\n", file.string(), countText(episodes.size()),
           playerOf(scene), is_played ? " found on disk" : "", arguments.directory);
  return kExitOk;
}

// By processes. Returns the number of controllers that are complete.
std::size_t evaluateInProcesses(const EvaluateArguments& arguments, const Scene& scene, const EpisodeRange& episodes, int num_processes) {
  std::vector<NamedPart> parts(1);
  parts[0] = {.name = "this evaluation", .part = playRange(arguments, scene, episodes, num_processes)};
  return reportParts(arguments, scene, parts);
}

// The same in this process. Reports the complete controllers also if the device is lost after them.
std::size_t evaluateAlone(const EvaluateArguments& arguments, const Scene& scene, const EpisodeRange& episodes) {
  const Device device = openDevice(arguments);
  RunDisplay display;
  std::vector<Evaluation> evaluations;
  const std::size_t num_controllers = namesOf(arguments, scene).size();
  EvaluateOptions options;
  options.batch_size = arguments.batch_size;
  options.stop = &stopOnSignals();
  options.on_progress = announced(scene, episodes, device, [&](const Progress& progress) { display.show(progress); });
  options.on_evaluation = [&](const Evaluation& evaluation) {
    evaluations.push_back(evaluation);
    if (num_controllers > 1) spdlog::info("controller {} evaluated ({} of {})", evaluation.controller, evaluations.size(), num_controllers);
  };
  const auto report = [&] {
    display.end();
    if (!evaluations.empty()) reportEvaluations(arguments.report, scene, deviceText(device.info()), evaluations);
  };
  try {
    evaluate(device, scene, arguments.controllers, options);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::kDevice) report();  // what was evaluated before the device was lost
    throw;
  }
  report();
  return evaluations.size();
}

int runEvaluate(const EvaluateArguments& arguments) {
  if (!arguments.merged.empty()) return mergeParts(arguments);
  const Scene scene = loadSceneOf(arguments);
  checkKind(arguments, scene);
  const EpisodeRange all{.first = 0, .end = scene.num_episodes};
  const EpisodeRange episodes = chosenEpisodes(arguments, scene.num_episodes).value_or(all);
  if (episodes.size() == 0) {
    printOut("{}: part {} of {} episodes is empty\n", arguments.directory, arguments.part, countText(scene.num_episodes));
    return kExitOk;
  }
  const int num_processes = usableProcesses(arguments.num_processes, episodes.size());
  setDriverThreads(num_processes);
  if (!arguments.directory.empty()) return playPart(arguments, scene, episodes, num_processes);
  const std::size_t num_evaluated = num_processes > 1 || scene.grasp ? evaluateInProcesses(arguments, scene, episodes, num_processes)
                                                                     : evaluateAlone(arguments, scene, episodes);
  if (!stopOnSignals()) return kExitOk;
  spdlog::warn("stopped: {} of {} {} are evaluated", num_evaluated, namesOf(arguments, scene).size(), std::string(playerOf(scene)) + "s");
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
  addProcessesOption(*command, arguments->num_processes);
  command->get_option("--processes")->excludes("--merge");
  command->add_option("--png", arguments->report.png, "Figure to write (PNG): settling, errors and success by start error")
      ->check(requirePngName)
      ->type_name("FILE");
  command->add_flag("--json", arguments->report.json, "Print JSON with every episode");
  command->callback([=, &action] { action = [=] { return runEvaluate(*arguments); }; });
}

}  // namespace taxelsim::cli
