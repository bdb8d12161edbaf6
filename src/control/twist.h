// Kinematics of twists in SE(3): exponential map, change of frame, integration. A twist is (v, w) of a frame in its own axes.
#pragma once

#include "taxelsim/pose.h"

namespace taxelsim {

// Twist of frame A from the twist of frame B on the same rigid body: the adjoint of X_AB.
Twist changeFrame(const Pose& X_AB, const Twist& twist_B);

// Exponential map exp(twist dt) in closed form: the pose of a frame after dt seconds at a constant twist, relative to its pose before
// (a screw motion).
Pose exponential(const Twist& twist, double dt);

// Pose of frame B after dt seconds at twist_B: X_WB exp(twist_B dt).
Pose integrate(const Pose& X_WB, const Twist& twist_B, double dt);

}  // namespace taxelsim
