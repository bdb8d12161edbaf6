#include "cli/worker_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "base/processors.h"
#include "cli/commands.h"
#include "cli/driver_threads.h"
#include "cli/shard_options.h"
#include "workers/worker_count.h"

namespace taxelsim::cli {

void addWorkerOptions(CLI::App& command, WorkerOptions& options) {
  command
      .add_option("--workers", options.num_workers,
                  "Processes that share the run, 1 for this one alone; default: with a software driver and at least " +
                      std::to_string(workers::kMinEpisodes) + " episodes one per processor, else 1")
      ->check(silent(CLI::Range(1, workers::kMaxWorkers)))
      ->type_name("N");
  command.add_option("--worker", options.role)->check(checkPart)->group("");
}

Team openTeam(const SceneOptions& scene, const WorkerOptions& options, std::uint64_t num_episodes, const std::function<int(int)>& limit) {
  const auto open = [&] { return Device::open({.device = scene.device, .validation = scene.validation}); };
  if (!options.role.empty()) {
    const auto [number, num_processes] = *numberPair(options.role, "/");
    return {.device = open(), .num_processes = static_cast<int>(num_processes), .number = static_cast<int>(number)};
  }
  if (options.num_workers) {
    const int num_processes = limit(*options.num_workers);
    setDriverThreads(num_processes);
    return {.device = open(), .num_processes = num_processes};
  }
  setDriverThreads(1);
  Team team{.device = open()};
  team.num_processes = limit(workers::defaultWorkers(team.device.info(), num_episodes, usableProcessors()));
  if (team.num_processes == 1) return team;
  setDriverThreads(team.num_processes);
  team.device = open();  // the driver reads the number when it starts
  return team;
}

}  // namespace taxelsim::cli
