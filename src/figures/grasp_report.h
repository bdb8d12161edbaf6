// Table, JSON and figure of experiments with grasps.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "taxelsim/experiment.h"

namespace taxelsim::figures {

// A row for each gain and finger.
std::string graspTable(const GraspExperiment& experiment, const std::vector<GraspRun>& runs);

// All results with every frame; SI units. Undefined values are null.
nlohmann::ordered_json graspJson(const GraspExperiment& experiment, const std::vector<GraspRun>& runs);

// forces.png: force over time, a panel per finger and a line per gain. Creates the directory. Throws Error(kIo) if it cannot be written to.
void drawGrasp(const std::filesystem::path& directory, const GraspExperiment& experiment, const std::vector<GraspRun>& runs);

}  // namespace taxelsim::figures
