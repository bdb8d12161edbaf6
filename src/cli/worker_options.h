// --workers of the commands that several processes can share, and the hidden --worker with which they start each other.
#pragma once

#include <CLI/App.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "cli/scene_options.h"
#include "taxelsim/device.h"

namespace taxelsim::cli {

struct WorkerOptions {
  std::optional<int> num_workers;  // processes, with this one
  std::string role;                // "2/4" in a worker that was started by the first of 4 processes; empty in that one
};

// Adds both options; `options` must outlive the parsing.
void addWorkerOptions(CLI::App& command, WorkerOptions& options);

// The device of a run, and the processes that share the run.
struct Team {
  Device device;
  int num_processes = 1;  // at least 1
  int number = 1;         // of this process, from 1; the others are workers
};

// Opens the device and decides how many processes share a run of so many episodes: as many as requested, or defaultWorkers(). `limit`
// returns how many of a number of processes the run can use. Call it in a program without other threads (setDriverThreads()).
Team openTeam(const SceneOptions& scene, const WorkerOptions& options, std::uint64_t num_episodes, const std::function<int(int)>& limit);

}  // namespace taxelsim::cli
