// evaluate() by several processes of this machine: each plays a range of the episodes.
#pragma once

#include <string>
#include <vector>

#include "taxelsim/evaluation_part.h"

namespace taxelsim::workers {

// As evaluate() of all episodes, with num_processes - 1 workers. Progress is that of all processes; a batch is divided between them. The
// episodes of a lost worker are played by this process. After a stop the result has the controllers that are complete in all processes.
std::vector<Evaluation> evaluateTogether(const Device& device, const Scene& scene, const std::vector<std::string>& controllers,
                                         const EvaluateOptions& options, int num_processes);

// The same for evaluatePart().
EvaluationPart evaluatePartTogether(const Device& device, const Scene& scene, const std::vector<std::string>& controllers,
                                    const EvaluateOptions& options, int num_processes);

// What worker `number` (2 to num_processes) of these does. Returns the exit status of the process.
int evaluateAsWorker(const Device& device, const Scene& scene, const std::vector<std::string>& controllers, EvaluateOptions options,
                     int number, int num_processes);

}  // namespace taxelsim::workers
