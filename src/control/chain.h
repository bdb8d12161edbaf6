// Forward kinematics and Jacobian of one sensor's chain, for one instance at a time: some hundreds of nanoseconds, no allocation. Plain
// arithmetic and the C library's sine and cosine, so that an instance's bits do not depend on its neighbours.
#pragma once

#include <vector>

#include "taxelsim/robot.h"

namespace taxelsim {

class Chain {
 public:
  // `num_joints` of the robot. The sensor has passed checkRobot().
  Chain(const MountedSensor& sensor, int num_joints);

  // X_BS at joint positions q (num_joints).
  Pose poseAt(const double* q) const;

  // The same, and the Jacobian (num_joints x 6): row j is the twist of S in its own axes, v then w, when joint j moves at 1.
  Pose poseAt(const double* q, double* jacobian) const;

 private:
  std::vector<ChainJoint> joints_;
  Pose X_JS_;
  int num_joints_;
};

}  // namespace taxelsim
