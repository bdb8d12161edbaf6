// Robot files, and the `robot` block of a scene (docs/file_formats.md).
#pragma once

#include <filesystem>

#include "scene/yaml_reader.h"
#include "taxelsim/robot.h"

namespace taxelsim {

// The robot of a scene: a file, relative to `directory`, or settings in place; a free-flying sensor if missing. Checks it and writes the
// block `robot` of the canonical text.
Robot readRobotBlock(const YamlMap& scene, const std::filesystem::path& directory);

}  // namespace taxelsim
