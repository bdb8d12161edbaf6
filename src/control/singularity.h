// Distance of a robot from a kinematic singularity.
#pragma once

#include <span>

#include "taxelsim/robot.h"

namespace taxelsim {

// The smallest singular value of the selected rows of the first sensor's Jacobian at joint positions q (num_joints). Lengths are in m and
// angles in rad, without scaling. With fewer joints than selected rows, there are as many singular values as joints.
double smallestSingularValue(const Manipulator& robot, std::span<const double> q);

}  // namespace taxelsim
