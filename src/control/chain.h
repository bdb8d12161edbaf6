// Forward kinematics and geometric Jacobian of the kinematic chain from a robot's base to one sensor.
//
// Evaluates one instance at a time, without allocation. Sine and cosine are those of base/sin_cos.h, so that a device computes the same
// bits: twin shaders/servo/chain.glsl. KDL is used for loading only (urdf_model.h).
#pragma once

#include <vector>

#include "taxelsim/robot.h"

namespace taxelsim {

class Chain {
 public:
  // `num_joints`: degrees of freedom of the robot. `sensor` must pass checkRobot().
  Chain(const MountedSensor& sensor, int num_joints);

  // X_BS at joint positions q (num_joints), rad or m.
  Pose poseAt(const double* q) const;

  // X_BS, and the transposed Jacobian (num_joints x 6): row j is the twist (v, w) of S in the axes of S per unit velocity of joint j.
  Pose poseAt(const double* q, double* jacobian) const;

 private:
  std::vector<ChainJoint> joints_;
  Pose X_JS_;
  int num_joints_;
};

}  // namespace taxelsim
