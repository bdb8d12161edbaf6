// The `objects` of a scene: meshes by file, analytic solids by their dimensions.
#pragma once

#include <filesystem>
#include <vector>

#include "scene/yaml_reader.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// Reads the objects of the scene `map`, loads their meshes (relative to `directory`) and checks them with checkObject(). `max_depth_error`:
// m, of meshes that have no key of that name.
std::vector<SceneObject> readObjects(const YamlMap& map, const std::filesystem::path& directory, double max_depth_error);

// Fails at the first object that has a `motion`, with `reason`.
void refuseMotions(const YamlMap& map, const std::string& reason);

}  // namespace taxelsim
