// The `controller` block of a scene, or its list of `controllers`, and the block `tactile_servo` of each.
#pragma once

#include <vector>

#include "scene/yaml_reader.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// The block `tactile_servo` of `outer`, which must have it.
TactileServo readTactileServo(const YamlMap& outer);

std::vector<SceneController> readControllers(const YamlMap& scene);

}  // namespace taxelsim
