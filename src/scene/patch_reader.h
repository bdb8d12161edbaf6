// The taxels of a sensor file: one grid, patches, a list, a mesh or a URDF.
#pragma once

#include <filesystem>
#include <vector>

#include "scene/yaml_reader.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// `map`: the sensor. Files are relative to `directory`.
std::vector<GridPatch> readPatches(const YamlMap& map, const std::filesystem::path& directory);

}  // namespace taxelsim
