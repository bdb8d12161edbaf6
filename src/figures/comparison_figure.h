// Figure of real images, simulated images and their differences, like figures 8 and 9 of the paper.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "taxelsim/compare.h"
#include "taxelsim/sensor.h"

namespace taxelsim::figures {

// An image and its title.
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

// One row per pair; taxels are placed as on the real sensor. Throws as writeTactileFigure().
void writeComparisonFigure(const std::filesystem::path& file, const Sensor& real_sensor, const Sensor& simulated_sensor,
                           const std::vector<ShownPair>& pairs, const ComparisonTitles& titles);

// "12.3 %"; "-" for NaN.
std::string percentText(double fraction);

}  // namespace taxelsim::figures
