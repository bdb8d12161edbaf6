// Poses on the command line.
#pragma once

#include <string>

#include "taxelsim/pose.h"

namespace taxelsim::cli {

// Reads "x y z qw qx qy qz", m and a unit quaternion, separated by blanks or commas; independent of the locale. Throws Error(kInput).
Pose parsePose(const std::string& text);

}  // namespace taxelsim::cli
