// The block `motion` of an object in a scene.
#pragma once

#include <filesystem>
#include <optional>

#include "scene/yaml_reader.h"
#include "taxelsim/trajectory.h"

namespace taxelsim {

// Empty if the object has no such block. Files are relative to `directory`.
std::optional<Motion> readMotion(const YamlMap& object, const std::filesystem::path& directory);

}  // namespace taxelsim
