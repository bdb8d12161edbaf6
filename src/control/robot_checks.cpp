#include <algorithm>
#include <cmath>

#include "control/value_checks.h"
#include "taxelsim/robot.h"

namespace taxelsim {
namespace {

constexpr double kUnitTolerance = 1e-9;  // of the squared norm of a quaternion

void require(bool is_valid, const char* field, double value, const char* allowed) {
  requireValue(is_valid, "robot", field, value, allowed);
}

void checkPose(const Pose& X, const char* field) {
  double square = 0;
  for (const double p : X.position) require(std::isfinite(p), field, p, "a finite position");
  for (const double q : X.rotation) square += q * q;
  require(std::abs(square - 1) <= kUnitTolerance, field, square, "a unit quaternion");
}

void checkJoint(const Joint& joint, const JointDrive& drive) {
  require(joint.lower <= joint.upper, "joint.lower", joint.lower, "a number <= upper");
  require(joint.max_velocity > 0, "joint.max_velocity", joint.max_velocity, "a velocity > 0");
  const bool is_within =
      std::isfinite(joint.initial_position) && joint.initial_position >= joint.lower && joint.initial_position <= joint.upper;
  require(is_within, "joint.initial_position", joint.initial_position, "within the joint's limits");
  const bool has_step =
      drive.position_step == 0 || std::ceil(joint.lower / drive.position_step) <= std::floor(joint.upper / drive.position_step);
  require(has_step, "drive.position_step", drive.position_step, "a step that has a multiple within the limits of each joint");
}

void checkSensor(const MountedSensor& sensor, std::size_t num_joints) {
  require(sensor.chain.size() <= static_cast<std::size_t>(kMaxChainJoints), "chain", static_cast<double>(sensor.chain.size()),
          "at most 64 joints");
  for (const ChainJoint& joint : sensor.chain) {
    checkPose(joint.X_PJ, "X_PJ");
    require(joint.joint >= 0 && joint.joint < static_cast<int>(num_joints), "chain.joint", joint.joint, "the index of a joint");
    require(std::isfinite(joint.multiplier), "multiplier", joint.multiplier, "a finite number");
    require(std::isfinite(joint.offset), "offset", joint.offset, "a finite number");
  }
  checkPose(sensor.X_JS, "X_JS");
}

}  // namespace

void checkRobot(const Robot& robot) {
  const auto* const manipulator = std::get_if<Manipulator>(&robot);
  if (manipulator == nullptr) return;
  const auto [num_joints, num_sensors] = std::pair(manipulator->joints.size(), manipulator->sensors.size());
  require(num_joints >= 1 && num_joints <= static_cast<std::size_t>(kMaxJoints), "joints", static_cast<double>(num_joints), "1 to 32");
  require(num_sensors >= 1 && num_sensors <= static_cast<std::size_t>(kMaxRobotSensors), "sensors", static_cast<double>(num_sensors),
          "1 to 64");
  const JointDrive& drive = manipulator->drive;
  require(isAtLeastZero(drive.position_step), "drive.position_step", drive.position_step, "a number >= 0");
  require(drive.delay >= 0 && drive.delay <= kMaxDelayTicks, "drive.delay", drive.delay, "0 to 1000 ticks");
  for (const Joint& joint : manipulator->joints) checkJoint(joint, drive);
  for (const MountedSensor& sensor : manipulator->sensors) checkSensor(sensor, num_joints);
  checkPose(manipulator->X_WB, "X_WB");
  const auto& selection = manipulator->selection;
  require(std::find(selection.begin(), selection.end(), true) != selection.end(), "selection", 0, "at least one coordinate");
  require(isPositive(manipulator->max_damping), "max_damping", manipulator->max_damping, "a number > 0");
  const double threshold = manipulator->singular_threshold;
  require(threshold > 0 && threshold <= 1, "singular_threshold", threshold, "a number > 0 and <= 1");
}

}  // namespace taxelsim
