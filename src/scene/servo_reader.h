// The `controller` block of a scene, or its list of `controllers`.
#pragma once

#include <vector>

#include "scene/yaml_reader.h"
#include "taxelsim/scene.h"

namespace taxelsim {

std::vector<SceneController> readControllers(const YamlMap& scene);

}  // namespace taxelsim
