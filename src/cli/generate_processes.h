// `taxelsim generate --processes`: each process makes a range of the shards.
#pragma once

#include "cli/scene_options.h"
#include "taxelsim/generate.h"

namespace taxelsim::cli {

// As generate() on the device of `scene_options`, by several processes (forkProcesses()). `options`: without stop and progress, which are
// those of the processes. Completes a whole data set as `taxelsim finish` does.
GenerateResult generateInProcesses(const SceneOptions& scene_options, const Scene& scene, const std::filesystem::path& directory,
                                   const GenerateOptions& options, int num_processes);

// Logs what is simulated on which device.
void logRun(const Scene& scene, const DeviceInfo& device);

}  // namespace taxelsim::cli
