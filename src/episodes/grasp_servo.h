// The tactile servo of a scene of kind grasp: moves an arm by the readings of one of the hand's sensors. Instances run in lockstep.
// Not thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "control/tactile_servo.h"
#include "episodes/sensed_robots.h"

namespace taxelsim {

class GraspServoLoop {
 public:
  // num_joints: of the robot. `servo` must outlive this.
  GraspServoLoop(const GraspServo& servo, std::span<const RobotSensor> sensors, int num_joints, int num_instances);

  // Starts an episode on all instances.
  void begin();
  // From the current frame of the robots: writes the velocities (num_instances x num_joints) at which the joints of the servo move in the
  // next dt (s), within their limits; 0 for all other joints.
  void command(const SensedRobots& robots, double dt, std::span<double> velocities);

 private:
  const GraspServo& servo_;
  TactileServoController controller_;
  bool is_first_frame_ = true;
  std::vector<std::uint8_t> follows_;  // (num_joints), 1: a joint of the servo

  // (num_instances)
  std::vector<Twist> twists_;
  std::vector<float> start_forces_;  // N
  std::vector<std::uint8_t> due_;
};

}  // namespace taxelsim
