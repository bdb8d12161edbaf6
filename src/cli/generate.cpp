// `taxelsim generate`: a scene becomes a data set.
#include "taxelsim/generate.h"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <memory>

#include "cli/commands.h"
#include "cli/progress.h"
#include "cli/text.h"

namespace taxelsim::cli {
namespace {

struct Arguments {
  std::string scene, directory, device;
  std::uint64_t num_episodes = 0, seed = 0;
  int batch_size = GenerateOptions{}.batch_size;
  bool validation = false;
};

std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");

// The first signal asks for an orderly end; the next one ends the process, as it would without us.
extern "C" void requestStop(int signal) {
  stop_requested = true;
  std::signal(signal, SIG_DFL);
}

int runGenerate(const Arguments& arguments, const SceneOverrides& overrides) {
  const Scene scene = loadScene(arguments.scene, overrides);
  const Device device = Device::open({.device = arguments.device, .validation = arguments.validation});
  spdlog::info("{}: {} episodes on {} ({})", scene.name, countText(scene.num_episodes), device.info().name, device.info().driver);

  std::signal(SIGINT, requestStop);
  std::signal(SIGTERM, requestStop);
  ProgressPrinter printer;
  bool told = false;
  GenerateOptions options;
  options.batch_size = arguments.batch_size;
  options.stop = &stop_requested;
  options.on_progress = [&](const Progress& progress) {
    if (!told && progress.episodes_resumed > 0) {
      printer.clear();
      spdlog::info("{} episodes found on disk", countText(progress.episodes_resumed));
    }
    told = true;
    printer.show(progress);
  };
  const GenerateResult result = generate(device, scene, arguments.directory, options);
  printer.clear();

  const Progress& progress = result.progress;
  if (!result.complete) {
    spdlog::warn("stopped: {} of {} episodes are in {}; the same command goes on from there", countText(progress.episodes_done),
                 countText(progress.num_episodes), arguments.directory);
    return kExitInterrupted;
  }
  const double rate = progress.seconds > 0 ? static_cast<double>(progress.frames_done) / progress.seconds : 0;
  fmt::print("{}: {} episodes ({} found on disk), {} frames made in {} at {} frames/s, {} loads out of reach\n", arguments.directory,
             countText(progress.num_episodes), countText(progress.episodes_resumed), countText(progress.frames_done),
             durationText(progress.seconds), countText(static_cast<std::uint64_t>(rate)), countText(result.num_load_misses));
  return kExitOk;
}

}  // namespace

void addGenerate(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("generate", "Simulate a scene into a data set; the same command again goes on where it was stopped");
  command->footer(
      "Example:\n  taxelsim generate scenes/edge_servo.yaml -o out/ --episodes 100000\n"
      "Ctrl-C keeps what is complete. Batch size and device memory do not change a byte of the data set.");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("scene", arguments->scene, "Scene file (YAML)")->required()->type_name("SCENE");
  command->add_option("-o,--output", arguments->directory, "Directory of the data set; made if it is not there")
      ->required()
      ->type_name("DIR");
  CLI::Option* episodes = command->add_option("--episodes", arguments->num_episodes, "Number of episodes, instead of the scene's")
                              ->check(refuseNegative)
                              ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 48))
                              ->type_name("N");
  CLI::Option* seed = command->add_option("--seed", arguments->seed, "Seed of all random numbers, instead of the scene's")
                          ->check(refuseNegative)
                          ->type_name("S");
  command->add_option("--batch-size", arguments->batch_size, "Sensors simulated at once")
      ->check(CLI::Range(1, 1 << 24))
      ->capture_default_str()
      ->type_name("B");
  command->add_option("--device", arguments->device, "discrete, integrated, cpu, a number of `taxelsim devices` or part of a name")
      ->type_name("D");
  command->add_flag("--validation", arguments->validation, "Run with Vulkan's validation layers; slow");
  command->callback([=, &action] {
    action = [=] {
      SceneOverrides overrides;
      if (episodes->count() > 0) overrides.num_episodes = arguments->num_episodes;
      if (seed->count() > 0) overrides.seed = arguments->seed;
      return runGenerate(*arguments, overrides);
    };
  });
}

}  // namespace taxelsim::cli
