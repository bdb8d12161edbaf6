// Conditions of a scene: named overrides of its sensor and of single keys of its randomization (docs/reference/scene_file.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/yaml_parse.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// Names of the conditions of a scene file, in its order; empty without the key `conditions`. Checks names and keys, not the values of the
// overrides. `file`: begin of messages. Throws Error(kInput).
std::vector<std::string> conditionNames(const YamlTree& scene, const std::string& file);

// The tree of a scene file with the overrides of one of its conditions; kNominalCondition leaves it as it is. Nodes keep their positions in
// the file. Throws Error(kInput), with the names that exist, for an unknown condition.
YamlTree inCondition(YamlTree scene, const std::string& file, std::string_view condition);

// Whether both sensors have the same patches and taxel positions, so that a policy can read either.
bool haveSameLayout(const Sensor& a, const Sensor& b);

}  // namespace taxelsim
