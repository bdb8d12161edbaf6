// `taxelsim evaluate` of a scene of kind grasp.
#pragma once

#include <string>
#include <vector>

#include "cli/evaluation_report.h"
#include "taxelsim/grasp_evaluation.h"

namespace taxelsim::cli {

// Prints the evaluations of some gains, one or more, as a table or JSON, and draws the figure, as `report` says.
void reportGrasps(const EvaluationReport& report, const Scene& scene, const std::string& device,
                  const std::vector<GraspEvaluation>& evaluations);

}  // namespace taxelsim::cli
