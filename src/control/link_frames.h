// Frames of the links of a URDF, for views of a robot.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "taxelsim/robot.h"

namespace taxelsim {

// All links of a URDF, each as a sensor at the origin of its link. `base_link`: the link at B; empty: the root. `joints`: those of the
// robot that loadUrdf() made of the file. All other joints stay at position 0. Throws what loadUrdf() throws.
std::vector<MountedSensor> linkFrames(const std::filesystem::path& file, const std::string& base_link, const std::vector<Joint>& joints);

}  // namespace taxelsim
