// Bar chart of a run: frames per second of every peer, by case, on a logarithmic axis.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "peers/contest.h"

namespace taxelsim::bench {

// Writes a PNG. `subtitle` names machine and driver. Throws Error(kIo) when the file cannot be written.
void writeBarChart(const std::filesystem::path& file, const std::string& subtitle, const std::vector<CaseResult>& results);

}  // namespace taxelsim::bench
