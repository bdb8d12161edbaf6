// Experiment files (docs/reference/experiment_file.md), one reader per kind.
#pragma once

#include <filesystem>
#include <vector>

#include "scene/yaml_reader.h"
#include "taxelsim/experiment.h"

namespace taxelsim {

// The list of 1 to 1000 numbers `key` of `map`.
std::vector<double> readList(const YamlMap& map, std::string_view key, const Allowed& allowed);

// The scene that the key `scene` names, of one kind.
Scene readSceneOfKind(const YamlMap& map, const std::filesystem::path& directory, Scene::Kind kind);

// Files are relative to `directory`.
StaticExperiment readStaticExperiment(const YamlNode& root, const std::filesystem::path& directory);
CharacterizationExperiment readCharacterizationExperiment(const YamlNode& root, const std::filesystem::path& directory);
ServoExperiment readServoExperiment(const YamlNode& root, const std::filesystem::path& directory);
GraspExperiment readGraspExperiment(const YamlNode& root, const std::filesystem::path& directory);
CalibrationExperiment readCalibrationExperiment(const YamlNode& root, const std::filesystem::path& directory);

}  // namespace taxelsim
