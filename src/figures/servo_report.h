// Tables, JSON and figures of the paper's servo experiments.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "taxelsim/experiment.h"

namespace taxelsim::figures {

// Convergence of a feature in a run; null if the run does not control it.
const ServoConvergence* convergenceOf(const ServoRunResult& run, ServoFeature feature);

// A table for each controlled feature, one of the robots, and one for each sweep.
std::string servoTables(const ServoExperiment& experiment, const ServoResult& result);

// All results with every frame of every run, without images; SI units. Undefined values are null.
nlohmann::ordered_json servoJson(const ServoExperiment& experiment, const ServoResult& result);

// angle.png: edge angle over time, one panel per group. features.png: other controlled features. robot.png: joints and the path of the
// sensor. theory.png: static characteristics and stability sweeps. <run>.png: tactile images at the start, midway and at the end (paper,
// figures 11 and 12). Creates the directory. Returns the number of figures. Throws Error(kIo) if it cannot be written to.
std::size_t drawServoFigures(const std::filesystem::path& directory, const ServoExperiment& experiment, const ServoResult& result);

}  // namespace taxelsim::figures
