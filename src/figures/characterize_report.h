// What a characterisation found, as pictures and as a page that opens without a network.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "taxelsim/characterize.h"

namespace taxelsim::cli {

// "2401 (2398 to 2404) counts/N"; "not determined: why" where the measurements do not tell.
std::string estimateText(const Estimate& estimate);

// Draws every figure, the gain map and the point spread function beside `report`, as REPORT_<what>.png. Returns the files, in the order in
// which they are to be looked at. Throws Error(kIo).
std::vector<std::filesystem::path> drawCharacterization(const std::filesystem::path& report, const Characterization& result);

// Writes the page, with the figures inside it. Whole or not at all. Throws Error(kIo).
void writeReport(const std::filesystem::path& report, std::span<const Measurement> measurements, const Characterization& result,
                 const std::vector<std::filesystem::path>& figures);

}  // namespace taxelsim::cli
