// How near a robot stands to a singular pose.
#pragma once

#include <span>

#include "taxelsim/robot.h"

namespace taxelsim {

// The smallest singular value of the selected rows of the first sensor's Jacobian at joint positions q (num_joints), m/s and rad/s as they
// are. Of fewer joints than rows, that of the joints.
double smallestSingularValue(const Manipulator& robot, std::span<const double> q);

}  // namespace taxelsim
