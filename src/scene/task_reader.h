// The `task` block of a scene.
#pragma once

#include <optional>

#include "scene/yaml_reader.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// `scene`: its objects and episode length are read. Empty if the file has no task.
std::optional<Task> readTask(const YamlMap& map, const Scene& scene);

}  // namespace taxelsim
