// Kinematic simulation of a batch of equal robots: commanded twists of their sensors in, poses of the sensors out, one control tick at a
// time. Joints reach commanded velocities immediately; there are no dynamics. Instances are independent: the results of an instance are
// bitwise equal in any batch. Not thread-safe. Allocates only in the constructor.
//
// A tick of a manipulator (resolved-rate control with joint limits):
//   1. Compute joint velocities by damped least squares with the Jacobian at the current joint positions.
//   2. If a joint exceeds its velocity limit, scale all velocities by the same factor, so that the direction of the twist is kept.
//   3. If the command of a joint would exceed its position limit, set its velocity such that it reaches the limit, remove it from the free
//      joints, and repeat from 1 with the remaining twist. All joints are free again at the start of the next tick.
//   4. Integrate the commands, which are never rounded. Each joint follows its command through its drive: quantization, delay and
//      velocity limit.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/thread_team.h"
#include "control/chain.h"
#include "control/damped_least_squares.h"
#include "taxelsim/robot.h"

namespace taxelsim {

// Bit flags: what limited the motion of an instance in its last tick; 0 if nothing did.
enum RobotStatus : std::uint8_t {
  kJointLimit = 1,     // a joint reached its position limit
  kVelocityLimit = 2,  // the twist exceeded a velocity limit, or a drive lags behind its command
  kSingular = 4,       // damping was applied near a singularity; the twist is followed in part only
  kLost = 8,           // the twist or the resulting pose was not finite; the robot did not move
};

class Robots {
 public:
  // All instances start as after reset(i). Throws Error(kInput) like checkRobot().
  Robots(const Robot& robot, int num_instances);

  int numInstances() const { return num_instances_; }
  int numJoints() const { return num_joints_; }    // 0 for FreeFlying
  int numSensors() const { return num_sensors_; }  // per instance

  // Sets instance i to rest at the joints' initial positions with the base at the robot's X_WB; FreeFlying: the sensor at the origin of W.
  void reset(int i);
  // As above, but with the base placed such that the first sensor is at X_WS.
  void reset(int i, const Pose& X_WS);
  // Sets instance i to rest at `positions` (num_joints) with the base at the robot's X_WB. Throws Error(kInput) if one is out of limits.
  void reset(int i, std::span<const double> positions);

  // Advances all robots by one tick of dt (s, > 0). twists (num_instances): commanded twists of the first sensor of each instance, in S.
  void command(std::span<const Twist> twists, double dt) { command(twists, {}, {}, dt); }
  // The same, but a manipulator with by_joints[i] != 0 (num_instances) follows joint_velocities (num_instances x num_joints; rad/s or m/s)
  // instead of the twist: steps 2 to 4, where step 3 stops each joint at its limit. The threads of `team` share the robots.
  void command(std::span<const Twist> twists, std::span<const double> joint_velocities, std::span<const std::uint8_t> by_joints, double dt,
               ThreadTeam& team);
  void command(std::span<const Twist> twists, std::span<const double> joint_velocities, std::span<const std::uint8_t> by_joints,
               double dt) {
    ThreadTeam alone(1);
    command(twists, joint_velocities, by_joints, dt, alone);
  }

  // Steps 1 to 3 for a part of the joints: writes the velocities (num_joints) at which the joints with follows[j] != 0 (num_joints) move
  // `sensor` by the twist, in S, within their limits in a tick of dt; 0 for the other joints. Returns what limits them, flags of
  // RobotStatus; all are 0 if that is kLost. Moves nothing. Manipulators only.
  std::uint8_t solve(int i, int sensor, const Twist& twist, std::span<const std::uint8_t> follows, double dt,
                     std::span<double> velocities) const;

  // Twist of the first sensor of an instance, in S, at joint velocities (num_joints) in its present posture. Manipulators only.
  Twist twistOf(int i, std::span<const double> joint_velocities) const;
  // The same of any sensor.
  Twist twistOf(int i, int sensor, std::span<const double> joint_velocities) const;

  std::span<const Pose> X_WB() const { return X_WB_; }                     // (num_instances), of the bases
  std::span<const Pose> X_WS() const { return X_WS_; }                     // (num_instances x num_sensors)
  std::span<const double> jointPositions() const { return positions_; }    // (num_instances x num_joints), rad or m
  std::span<const double> jointVelocities() const { return velocities_; }  // the same of the joints, not of their commands; rad/s or m/s
  std::span<const std::uint8_t> status() const { return status_; }         // (num_instances), flags of RobotStatus

 private:
  struct Limits {
    double lower, upper, max_velocity;
  };

  void stepFreeFlying(int i, const Twist& twist, double dt);
  void stepManipulator(int i, const Twist& twist, double dt);
  void stepJoints(int i, std::span<const double> joint_velocities, double dt);
  void drive(int i, const double* joint_velocities, double dt);
  std::uint8_t solveVelocities(int i, const double* jacobian, std::array<bool, kMaxJoints> is_free, const Twist& twist, double dt,
                               double* velocities) const;
  bool limitVelocities(int i, double dt, double* velocities);
  void setAtRest(int i, std::span<const double> positions, const Pose& X_WB);
  double quantized(int joint, double command) const;
  void updateSensors(int i);
  double* instanceRow(std::vector<double>& values, int i) { return values.data() + static_cast<std::ptrdiff_t>(i) * num_joints_; }
  const double* instanceRow(const std::vector<double>& values, int i) const {
    return values.data() + static_cast<std::ptrdiff_t>(i) * num_joints_;
  }
  double* instanceJacobian(int i) { return jacobians_.data() + static_cast<std::ptrdiff_t>(i) * num_joints_ * 6; }

  int num_instances_;
  int num_joints_ = 0;
  int num_sensors_ = 1;
  std::vector<Chain> chains_;               // (num_sensors); empty for FreeFlying
  std::vector<DampedLeastSquares> solver_;  // one; empty for FreeFlying
  std::vector<Limits> limits_;              // (num_joints)
  std::vector<double> initial_;             // (num_joints)
  JointDrive joint_drive_;
  Pose X_WB_initial_;
  int delay_index_ = 0;  // row of the ring buffer delayed_ that the current tick reads and then overwrites

  // Arrays (num_instances x ...):
  std::vector<Pose> X_WB_;
  std::vector<Pose> X_WS_;          // num_sensors
  std::vector<double> positions_;   // num_joints
  std::vector<double> velocities_;  // num_joints
  std::vector<double> commands_;    // num_joints
  std::vector<double> delayed_;     // num_joints; (delay x num_instances x num_joints): ring buffer of drive targets
  std::vector<double> jacobians_;   // num_joints x 6; of the first sensor, at positions_
  std::vector<std::uint8_t> status_;
};

}  // namespace taxelsim
