// What `taxelsim evaluate` prints and draws.
#pragma once

#include <string>
#include <vector>

#include "taxelsim/evaluate.h"

namespace taxelsim::cli {

struct EvaluationReport {
  bool json = false;  // instead of a table
  std::string png;    // figure to write; empty: none
};

// Prints the evaluations, of which there is at least one, and writes the figure. `device`: name and driver.
void reportEvaluations(const EvaluationReport& report, const Scene& scene, const std::string& device,
                       const std::vector<Evaluation>& evaluations);

}  // namespace taxelsim::cli
