// Robot files, and the `robot` block of a scene (docs/file_formats.md).
#pragma once

#include <filesystem>

#include "scene/yaml_reader.h"
#include "taxelsim/robot.h"

namespace taxelsim {

// The robot that the key `robot` of a scene names by a file, relative to `directory`, or gives in place; a free-flying sensor when it is
// not there. Checked, and as the block `robot` of the canonical text.
Robot readRobotBlock(const YamlMap& scene, const std::filesystem::path& directory);

}  // namespace taxelsim
