// Panels that show one value per taxel of one sensor.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "figures/tactile_figure.h"
#include "taxelsim/sensor.h"

namespace taxelsim::figures {

// One panel per patch, one for a list of taxels.
struct SensorPanels {
  std::vector<TactilePanel> panels{};
  std::vector<std::size_t> first{};  // (panels), index of the first taxel of each
};

// `values`: (num_taxels). `title`: of each panel, after the name of the patch where there are several.
SensorPanels panelsOf(const Sensor& sensor, std::span<const double> values, const std::string& title);

}  // namespace taxelsim::figures
