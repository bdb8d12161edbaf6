// Tables, JSON and figure of the paper's calibration with a pin.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "taxelsim/experiment.h"

namespace taxelsim::figures {

// Forces at the measured depths and counts at the measured forces, a row per sensor and point.
std::string calibrationTables(const CalibrationExperiment& experiment, std::span<const CalibrationCurves> sensors);

// All curves; SI units. Values of loads that a skin does not carry are null.
nlohmann::ordered_json calibrationJson(const CalibrationExperiment& experiment, std::span<const CalibrationCurves> sensors);

// calibration.png: force against depth (paper, figure 6b) and counts against force (figure 5b), with the measured points. Creates the
// directory. Throws Error(kIo) if it cannot be written to.
void drawCalibration(const std::filesystem::path& directory, const CalibrationExperiment& experiment,
                     std::span<const CalibrationCurves> sensors);

}  // namespace taxelsim::figures
