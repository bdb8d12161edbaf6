// `taxelsim generate`: simulates a scene and writes a data set.
#include "taxelsim/generate.h"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/commands.h"
#include "cli/driver_threads.h"
#include "cli/generate_processes.h"
#include "cli/interrupt.h"
#include "cli/print.h"
#include "cli/processes.h"
#include "cli/run_display.h"
#include "cli/scene_options.h"
#include "cli/shard_options.h"
#include "figures/text.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

struct GenerateArguments : SceneOptions, ShardOptions {
  std::string directory;
  int num_processes = 1;
  bool repair = false;
};

void warnOfLoads(const Scene& scene, const GenerateResult& result) {
  for (std::size_t object = 0; object < result.load_misses.size(); ++object) {
    const LoadMisses& misses = result.load_misses[object];
    if (misses.num_misses == 0) continue;
    const auto [least, most] = misses.carried;
    const std::string carried = least == most ? fmt::format("{:.3g} N", most) : fmt::format("{:.3g} to {:.3g} N", least, most);
    spdlog::warn("object {}: load out of reach in {} of its {} episodes; pressed through the skin, it carried {}",
                 scene.objects[object].object.name, countText(misses.num_misses), countText(misses.num_episodes), carried);
  }
}

// "shards 40 to 79 of 120", "shard 3 of 4"
std::string shardsText(const ShardRange& shards, std::uint64_t num_shards) {
  const std::uint64_t last = shards.end - 1;
  return shards.first == last ? fmt::format("shard {} of {}", last, countText(num_shards))
                              : fmt::format("shards {} to {} of {}", shards.first, last, countText(num_shards));
}

// In this process.
GenerateResult generateAlone(const GenerateArguments& arguments, const Scene& scene, GenerateOptions options) {
  const Device device = openDevice(arguments);
  RunDisplay display;
  logRun(scene, device.info());
  options.stop = &stopOnSignals();
  options.on_verify = [&](std::uint64_t num_verified, std::uint64_t num_found) {
    if (num_verified == num_found) return display.activity().next("preparing the simulation");
    if (num_verified == 0) display.activity().next("verifying");
    display.activity().rename(fmt::format("verifying: {} of {} shards", countText(num_verified), countText(num_found)));
  };
  options.on_progress = [&](const Progress& progress) { display.show(progress); };
  return generate(device, scene, arguments.directory, options);
}

int runGenerate(const GenerateArguments& arguments) {
  const Scene scene = loadSceneOf(arguments);
  const std::uint64_t num_shards = (scene.num_episodes + scene.episodes_per_shard - 1) / scene.episodes_per_shard;
  const std::optional<ShardRange> shards = chosenShards(arguments, num_shards);
  if (shards && shards->first == shards->end) {
    printOut("{}: part {} of {} shards is empty\n", arguments.directory, arguments.part, num_shards);
    return kExitOk;
  }
  GenerateOptions options;
  options.batch_size = arguments.batch_size;
  options.repair = arguments.repair;
  options.shards = shards;
  const int num_processes = usableProcesses(arguments.num_processes, shards ? shards->end - shards->first : num_shards);
  setDriverThreads(num_processes);
  const GenerateResult result = num_processes > 1 ? generateInProcesses(arguments, scene, arguments.directory, options, num_processes)
                                                  : generateAlone(arguments, scene, options);
  warnOfLoads(scene, result);

  const Progress& progress = result.progress;
  if (!result.verified) {
    spdlog::warn("stopped before the shards in {} were verified; run the same command again to resume", arguments.directory);
    return kExitInterrupted;
  }
  if (!result.complete) {
    spdlog::warn("stopped: {} of {} episodes are in {}; run the same command again to resume", countText(progress.episodes_done),
                 countText(progress.num_episodes), arguments.directory);
    return kExitInterrupted;
  }
  if (shards) {
    printOut("{}: {} complete, {} episodes ({} found on disk); `taxelsim finish {}` completes the data set\n", arguments.directory,
             shardsText(*shards, num_shards), countText(progress.num_episodes), countText(progress.episodes_resumed), arguments.directory);
    return kExitOk;
  }
  const double rate = progress.seconds > 0 ? static_cast<double>(progress.frames_done) / progress.seconds : 0;
  printOut("{}: {} episodes ({} found on disk), {} frames simulated in {} at {} frames/s\n", arguments.directory,
           countText(progress.num_episodes), countText(progress.episodes_resumed), countText(progress.frames_done),
           durationText(progress.seconds), countText(static_cast<std::uint64_t>(rate)));
  return kExitOk;
}

}  // namespace

void addGenerate(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("generate", "Simulate a scene and write a data set; run the same command again to resume");
  command->footer(
      "Example:\n  taxelsim generate scenes/edge_servo.yaml -o out/ --episodes 100000\n"
      "On a machine with many cores and no GPU:\n"
      "  taxelsim generate scenes/edge_servo.yaml -o out/ --episodes 100000 --processes 16\n"
      "On several machines of one kind, which share out/, K = 1 to 16:\n"
      "  taxelsim generate scenes/edge_servo.yaml -o out/ --episodes 100000 --part K/16\n"
      "  taxelsim finish out/\n"
      "Ctrl-C stops and keeps complete shards. The bytes of the data set do not depend on batch size or device memory.");
  const auto arguments = std::make_shared<GenerateArguments>();
  addSceneOptions(*command, *arguments, GenerateOptions{}.batch_size);
  command->add_option("-o,--output", arguments->directory, "Directory of the data set; created if missing")->required()->type_name("DIR");
  addShardOptions(*command, *arguments);
  addProcessesOption(*command, arguments->num_processes);
  command->add_flag("--repair", arguments->repair, "Make damaged and foreign shards again; without it they are an error");
  command->callback([=, &action] { action = [=] { return runGenerate(*arguments); }; });
}

}  // namespace taxelsim::cli
