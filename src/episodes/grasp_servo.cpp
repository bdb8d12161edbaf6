#include "episodes/grasp_servo.h"

#include "episodes/sensor_features.h"

namespace taxelsim {

GraspServoLoop::GraspServoLoop(const GraspServo& servo, std::span<const RobotSensor> sensors, int num_joints, int num_instances)
    : servo_(servo),
      controller_(servo.servo, sensors[static_cast<std::size_t>(servo.sensor)].sensor, num_instances),
      follows_(static_cast<std::size_t>(num_joints)),
      twists_(static_cast<std::size_t>(num_instances)),
      start_forces_(twists_.size()),
      due_(twists_.size(), 1) {
  for (const int joint : servo.joints) follows_[static_cast<std::size_t>(joint)] = 1;
}

void GraspServoLoop::begin() {
  is_first_frame_ = true;
  for (std::size_t i = 0; i < twists_.size(); ++i) controller_.reset(static_cast<int>(i));
}

void GraspServoLoop::command(const SensedRobots& robots, double dt, std::span<double> velocities) {
  const FrameView& frame = robots.frame(servo_.sensor);
  if (is_first_frame_) {
    for (std::size_t i = 0; i < twists_.size(); ++i) start_forces_[i] = frame.total_force[robots.row(servo_.sensor, static_cast<int>(i))];
    is_first_frame_ = false;
  }
  const auto sensors_per_instance = static_cast<int>(robots.row(servo_.sensor, 1) - robots.row(servo_.sensor, 0));
  const auto index = static_cast<int>(robots.row(servo_.sensor, 0));
  ServoInput input = featuresOfSensor(frame, sensors_per_instance, index, needsContactFeatures(servo_.servo));
  input.start_force = start_forces_;
  input.due = due_;
  controller_.command(input, dt, twists_);
  for (std::size_t i = 0; i < twists_.size(); ++i) {
    robots.robots().solve(static_cast<int>(i), servo_.sensor, twists_[i], follows_, dt,
                          velocities.subspan(i * follows_.size(), follows_.size()));
  }
}

}  // namespace taxelsim
