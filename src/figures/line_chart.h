// Charts of curves: pages of plots, each with title and legend.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "figures/line_plot.h"

namespace taxelsim::figures {

struct LineChartOptions {
  std::string title{};
  std::string subtitle{};
  int num_columns = 0;  // of panels; 0: two, or one for a single panel
};

// Cumulative share of episodes (%) over their values; values that are not finite count in the total only.
LineSeries cumulativeShare(const std::string& name, std::vector<double> values);

// Writes a PNG of all panels. Throws Error(kIo) if the file cannot be written; Error(kInput) if there is no panel, the arrays of a series
// differ in length, a range is empty, or the picture is larger than Cairo supports.
void writeLineChart(const std::filesystem::path& file, const std::vector<LinePanel>& panels, const LineChartOptions& options);

}  // namespace taxelsim::figures
