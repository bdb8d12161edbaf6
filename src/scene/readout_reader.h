// The block `readout` of a sensor.
#pragma once

#include <vector>

#include "scene/yaml_reader.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// `patches`: the sensor's, for the number of taxels.
Readout readReadout(const YamlMap& sensor, const std::vector<GridPatch>& patches);

}  // namespace taxelsim
