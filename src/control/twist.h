// Twists and the free-flying robot: how a frame moves when it is driven at a constant velocity. Not dynamics: velocities are reached at
// once.
#pragma once

#include "taxelsim/pose.h"

namespace taxelsim {

// The twist of A from the twist of B, where A and B are fixed to each other by X_AB.
Twist changeFrame(const Pose& X_AB, const Twist& twist_B);

// exp(twist dt) in SE(3), in closed form: where a frame is after dt seconds at a constant twist, seen from where it was.
Pose exponential(const Twist& twist, double dt);

// A free-flying frame B driven at twist_B for dt seconds: X_WB exp(twist_B dt).
Pose integrate(const Pose& X_WB, const Twist& twist_B, double dt);

}  // namespace taxelsim
