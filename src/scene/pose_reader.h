// Poses and rotations: `position`, and `rotation` (w, x, y, z) or `rpy`.
#pragma once

#include <string_view>

#include "scene/yaml_reader.h"
#include "taxelsim/pose.h"

namespace taxelsim {

// The block `key` of `parent`: {position[_mm], rotation | rpy[_deg]}; the identity if missing.
Pose readPose(const YamlMap& parent, std::string_view key);

// The same without a position.
Quaternion readRotation(const YamlMap& parent, std::string_view key);

}  // namespace taxelsim
