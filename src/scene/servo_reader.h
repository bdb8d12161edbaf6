// The `controller` block of a scene.
#pragma once

#include "scene/yaml_reader.h"
#include "taxelsim/control.h"

namespace taxelsim {

TactileServo readController(const YamlMap& scene);

}  // namespace taxelsim
