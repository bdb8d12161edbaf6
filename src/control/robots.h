// A batch of robots of one kind: twists of their sensors in, poses of the sensors out, a control tick at a time. Instances do not know each
// other: what one does is the same, to the bit, alone and in any batch. Allocates nothing after construction.
//
// What a manipulator does in a tick:
//   1. the Jacobian where the joints are, damped least squares: joint velocities
//   2. faster than a joint may: all are scaled, so that the sensor keeps its direction
//   3. a joint whose command would pass a limit goes to that limit, and the others follow what is left of the twist; 2 and 3 again until no
//      further joint does. A joint at a limit may leave it at any time.
//   4. the command, which is never rounded, moves by velocity times dt; the joint follows it through its drive
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "control/chain.h"
#include "control/damped_least_squares.h"
#include "taxelsim/robot.h"

namespace taxelsim {

// Of an instance, what held it back in its last tick: any sum of these, 0 for nothing.
enum RobotStatus : std::uint8_t {
  kJointLimit = 1,     // a joint was stopped at its position limit
  kVelocityLimit = 2,  // the twist was too fast, or the drive lags behind its command
  kSingular = 4,       // the Jacobian was damped: part of the twist may be missing
  kLost = 8,           // the twist was not finite, or led to no finite pose; the robot stood still
};

class Robots {
 public:
  // Every instance as reset(i) leaves it. Throws Error(kInput) as checkRobot() does.
  Robots(const Robot& robot, int num_instances);

  int numInstances() const { return num_instances_; }
  int numJoints() const { return num_joints_; }    // 0 where the sensor flies
  int numSensors() const { return num_sensors_; }  // per instance

  // Instance i at rest with its joints where the robot's description has them and its base at X_WB; a flying sensor at the origin.
  void reset(int i);
  // The same with the base placed so that its first sensor is at X_WS.
  void reset(int i, const Pose& X_WS);
  // At rest with the base at X_WB and joints at `positions` (num_joints), which lie within their limits: throws Error(kInput) otherwise.
  void reset(int i, std::span<const double> positions);

  // All robots move for one tick of dt seconds, > 0, the first sensor of instance i at twists[i] (num_instances) in its own axes.
  void command(std::span<const Twist> twists, double dt);

  std::span<const Pose> X_WS() const { return X_WS_; }                     // (num_instances x num_sensors)
  std::span<const double> jointPositions() const { return positions_; }    // (num_instances x num_joints), rad or m
  std::span<const double> jointVelocities() const { return velocities_; }  // the same, rad/s or m/s: of the joints, not of the commands
  std::span<const std::uint8_t> status() const { return status_; }         // (num_instances), of RobotStatus

 private:
  struct Limits {
    double lower, upper, max_velocity;
  };

  void fly(int i, const Twist& twist, double dt);
  void drive(int i, const Twist& twist, double dt);
  bool follow(int i, const Twist& twist, double dt, double* velocities);
  void stand(int i, std::span<const double> positions, const Pose& X_WB);
  double goalOf(int joint, double command) const;
  void placeSensors(int i);
  double* jointsOf(std::vector<double>& values, int i) { return values.data() + static_cast<std::ptrdiff_t>(i) * num_joints_; }
  double* jacobianOf(int i) { return jacobians_.data() + static_cast<std::ptrdiff_t>(i) * num_joints_ * 6; }

  int num_instances_;
  int num_joints_ = 0;
  int num_sensors_ = 1;
  std::vector<Chain> chains_;               // (num_sensors); none where the sensor flies
  std::vector<DampedLeastSquares> solver_;  // one, or none where the sensor flies
  std::vector<Limits> limits_;              // (num_joints)
  std::vector<double> initial_;             // (num_joints)
  JointDrive joint_drive_;
  Pose X_WB_initial_;
  int tick_ = 0;  // the slot of delayed_ that this tick reads and fills; the same for all instances

  // (num_instances) each, times what is said.
  std::vector<Pose> X_WB_;
  std::vector<Pose> X_WS_;          // num_sensors
  std::vector<double> positions_;   // num_joints
  std::vector<double> velocities_;  // num_joints
  std::vector<double> commands_;    // num_joints
  std::vector<double> delayed_;     // delay x num_joints: goals on their way
  std::vector<double> jacobians_;   // num_joints x 6, of the first sensor at positions_
  std::vector<std::uint8_t> status_;
};

}  // namespace taxelsim
