// Figures and HTML report of a characterisation; the report needs no other files.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "taxelsim/characterize.h"

namespace taxelsim::figures {

// "2401 (2398 to 2404) counts/N", or "not determined: REASON".
std::string estimateText(const Estimate& estimate);

// Draws all figures, the gain map and the point spread function as REPORT_<figure>.png in the folder of `report`. Returns the files in the
// order of the report. Throws Error(kIo).
std::vector<std::filesystem::path> drawCharacterization(const std::filesystem::path& report, const Characterization& result);

// Writes the report atomically, with the figures embedded. Throws Error(kIo).
void writeReport(const std::filesystem::path& report, std::span<const Measurement> measurements, const Characterization& result,
                 const std::string& scores, const std::vector<std::filesystem::path>& figures);

}  // namespace taxelsim::figures
