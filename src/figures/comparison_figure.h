// Real images, simulated images and their differences beside each other, in the manner of figures 8 and 9 of the paper.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "taxelsim/compare.h"
#include "taxelsim/sensor.h"

namespace taxelsim::cli {

// An image of one side and what stands over it.
struct ShownImage {
  std::string title;
  std::span<const float> counts;  // (num_taxels)
};

struct ShownPair {
  ShownImage real, simulated;
  ImageComparison comparison;
};

struct ComparisonTitles {
  std::string title, subtitle;
};

// One row a pair, the taxels laid out as those of the real sensor. Throws what writeTactileFigure() throws.
void writeComparisonFigure(const std::filesystem::path& file, const Sensor& real_sensor, const Sensor& simulated_sensor,
                           const std::vector<ShownPair>& pairs, const ComparisonTitles& titles);

// "12.3 %"; "-" for what is not defined.
std::string percentText(double fraction);

}  // namespace taxelsim::cli
