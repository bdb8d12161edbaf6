// What `taxelsim experiment` says and draws of the paper's dynamic experiments.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "taxelsim/experiment.h"

namespace taxelsim::cli {

// A table for each feature that is held, one of robots and one of each sweep.
std::string servoTables(const ServoExperiment& experiment, const ServoResult& result);

// Everything, every frame of every run included but for images; SI units. What is not known is null.
nlohmann::ordered_json servoJson(const ServoExperiment& experiment, const ServoResult& result);

// angle.png: the edge's angle over time, a panel a group; features.png: the other features that are held; robot.png: joints and the
// sensor's path; theory.png: what theories rest on; <run>.png: tactile images at the start, midway and at the end (paper, figures 11 and
// 12). Makes the directory. Throws Error(kIo) when it cannot be written to.
void drawServoFigures(const std::filesystem::path& directory, const ServoExperiment& experiment, const ServoResult& result);

}  // namespace taxelsim::cli
