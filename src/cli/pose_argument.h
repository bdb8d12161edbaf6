// Poses on the command line.
#pragma once

#include <optional>
#include <string>

#include "taxelsim/pose.h"

namespace taxelsim::cli {

// Value of --pose.
struct PoseArgument {
  Vector3 position;                    // m
  std::optional<Quaternion> rotation;  // none for a position alone
};

// Reads "x y z" or "x y z qw qx qy qz", m and a unit quaternion. Numbers are separated by blanks or commas; independent of the locale.
// Throws Error(kInput).
PoseArgument parsePose(const std::string& text);

// Reads the value of --rpy-deg, "roll pitch yaw": degrees about the fixed axes x, y and z, in this order, as `rpy_deg` of a scene. Throws
// Error(kInput).
Quaternion parseRollPitchYaw(const std::string& text);

// Reads the value of --slide, "x y": m along x and y of the sensor frame. Throws Error(kInput).
Vector3 parseSlide(const std::string& text);

}  // namespace taxelsim::cli
