// `taxelsim evaluate` of a scene of kind grasp.
#pragma once

#include <vector>

#include "cli/evaluation_report.h"
#include "cli/scene_options.h"

namespace taxelsim::cli {

// Evaluates the fingers with each of the gains (1/s), or with that of the scene if there are none, by at most so many processes, and prints
// the result. Returns the exit code.
int evaluateGraspScene(const SceneOptions& options, const Scene& scene, const std::vector<double>& gains, const EvaluationReport& report,
                       int num_processes);

}  // namespace taxelsim::cli
