// What `taxelsim evaluate` prints and draws.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "taxelsim/evaluate.h"

namespace taxelsim::cli {

struct EvaluationReport {
  bool json = false;  // instead of a table
  std::string png;    // figure to write; empty: none
};

// "median / 95th percentile" in a unit of which `per_si` make one SI unit, and all of them with null for undefined values.
std::string quantilesText(const Quantiles& quantiles, double per_si);
nlohmann::ordered_json quantilesJson(const Quantiles& quantiles);

// Prints JSON or a table, and draws the figure if it has a name.
void reportBy(const EvaluationReport& report, const std::function<void()>& print_json, const std::function<void()>& print_table,
              const std::function<void()>& draw);

// Prints the evaluations, of which there is at least one, and writes the figure. `device`: name and driver.
void reportEvaluations(const EvaluationReport& report, const Scene& scene, const std::string& device,
                       const std::vector<Evaluation>& evaluations);

}  // namespace taxelsim::cli
