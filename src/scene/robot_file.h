// Robot files, and the `robot` block of a scene (docs/reference/scene_file.md).
#pragma once

#include <filesystem>
#include <vector>

#include "scene/yaml_reader.h"
#include "taxelsim/grasp.h"
#include "taxelsim/robot.h"

namespace taxelsim {

// The robot of a scene: a file, relative to `directory`, or settings in place; a free-flying sensor if missing. Checks it and writes the
// block `robot` of the canonical text.
//
// `sensors`: receives the named sensors of the mounts, which must then all have `name` and `sensor`. Null: a mount must have neither.
Robot readRobotBlock(const YamlMap& scene, const std::filesystem::path& directory, std::vector<RobotSensor>* sensors = nullptr);

// The robot of a file alone. `sensors`: receives the named sensors of its mounts; empty if the mounts have none. Throws Error(kInput).
Robot loadRobotFile(const std::filesystem::path& file, std::vector<RobotSensor>& sensors);

}  // namespace taxelsim
