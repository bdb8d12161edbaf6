// Robot files, and the `robot` block of a scene (docs/reference/scene_file.md).
#pragma once

#include <filesystem>
#include <string>
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

// Whether a YAML file is a scene: it has the key `kind`. Throws Error(kInput) for a file that is missing or malformed.
bool isSceneFile(const std::filesystem::path& file);

// A robot with the description of its links.
struct LoadedRobot {
  Robot robot = {};
  std::vector<RobotSensor> sensors = {};  // named sensors of the mounts; empty if the mounts have none
  std::vector<std::string> names = {};    // (number of mounts), of the sensors; "sensor 0" and so on for mounts without names
  std::filesystem::path urdf = {};        // empty: no URDF describes the robot
  std::string base_link = {};             // the link of the URDF at B; empty: its root
};

// The robot of a robot file, or of a scene. Checks the robot alone. Throws Error(kInput).
LoadedRobot loadRobotFile(const std::filesystem::path& file);

}  // namespace taxelsim
