// generate() by several processes of this machine in one directory: each shard is made by the one that claims it.
#pragma once

#include <filesystem>

#include "taxelsim/generate.h"

namespace taxelsim::workers {

// The processes with this one that generate() may be shared by, at most `num_processes`: as many as there are shards, and as fit into
// memory.
int fittingWorkers(const Scene& scene, const GenerateOptions& options, int num_processes);

// As generate(), with num_processes - 1 workers. Progress and result are those of all processes; a batch is divided between them. The
// shards of a lost worker are made by the others.
GenerateResult generateTogether(const Device& device, const Scene& scene, const std::filesystem::path& directory, GenerateOptions options,
                                int num_processes);

// The part of a worker in generateTogether(). Returns the exit status of the process.
int generateAsWorker(const Device& device, const Scene& scene, const std::filesystem::path& directory, GenerateOptions options,
                     int num_processes);

}  // namespace taxelsim::workers
