// Taxels with individual poses: a list, a mesh, a URDF (docs/reference/sensor_file.md).
#pragma once

#include <filesystem>
#include <vector>

#include "scene/yaml_reader.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

inline constexpr int kMaxListTaxels = 4096;

// `taxels`: a list of {position[_mm], normal, size[_mm], x_axis}.
std::vector<GridPatch> readTaxelList(const YamlMap& sensor);

// `taxel_mesh`: {file, scale, up_axis, sha256}.
std::vector<GridPatch> readTaxelMesh(const YamlMap& sensor, const std::filesystem::path& directory);

// `urdf`: {file, sensor, sha256}.
std::vector<GridPatch> readTaxelUrdf(const YamlMap& sensor, const std::filesystem::path& directory);

}  // namespace taxelsim
