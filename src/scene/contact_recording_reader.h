// Recorded contact points of a scene of kind contact_points.
#pragma once

#include <filesystem>

#include "scene/yaml_reader.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// Reads the block `contact_points` and its file (docs/reference/scene_file.md). scene.sensor and scene.num_steps must have been read.
ContactRecording readContactRecording(const YamlMap& map, const std::filesystem::path& directory, const Scene& scene);

}  // namespace taxelsim
