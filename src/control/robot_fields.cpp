#include "control/robot_fields.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/field_checks.h"

namespace taxelsim {
namespace {

constexpr double kUnitTolerance = 1e-9;  // of the squared norm of a quaternion

void checkCount(const std::string& field, std::size_t count, int min, int max) {
  const Allowed allowed = Allowed::within(min, max, "");
  if (!isAllowed(static_cast<double>(count), allowed)) failField(field, "a list of " + std::to_string(count), describeWhole(allowed));
}

void checkPose(const std::string& field, const Pose& X) {
  for (std::size_t i = 0; i < 3; ++i) checkNumber(elementOf(field + ".position", i), X.position[i], Allowed::any("m"));
  double square = 0;
  for (const double q : X.rotation) square += q * q;
  if (!(std::abs(square - 1) <= kUnitTolerance)) {
    failField(field + ".rotation", "a quaternion of length " + numberText(std::sqrt(square)), "length 1");
  }
}

void checkJoint(const std::string& field, const Joint& joint, const JointDrive& drive) {
  if (!(joint.lower <= joint.upper)) {
    failField(field + ".lower", numberText(joint.lower), "at most upper (" + numberText(joint.upper) + ")");
  }
  checkFields(field + ".", kJointFields, joint);
  checkNumber(field + ".initial_position", joint.initial_position, Allowed::within(joint.lower, joint.upper, ""));
  const double step = drive.position_step;
  if (step > 0 && std::ceil(joint.lower / step) > std::floor(joint.upper / step)) {
    failField("position_step", numberText(step), "a step that has a multiple within the limits of each joint");
  }
}

void checkSensor(const std::string& field, const MountedSensor& sensor, std::size_t num_joints) {
  checkCount(field + ".chain", sensor.chain.size(), 0, kMaxChainJoints);
  for (std::size_t j = 0; j < sensor.chain.size(); ++j) {
    const ChainJoint& joint = sensor.chain[j];
    const std::string path = elementOf(field + ".chain", j);
    checkPose(path + ".X_PJ", joint.X_PJ);
    if (joint.joint < 0 || joint.joint >= static_cast<int>(num_joints)) {
      failField(path + ".joint", std::to_string(joint.joint), "the index of one of " + std::to_string(num_joints) + " joints");
    }
    checkFields(path + ".", kChainJointFields, joint);
  }
  checkPose(field + ".X_JS", sensor.X_JS);
}

}  // namespace

void checkRobot(const Robot& robot) {
  const auto* const manipulator = std::get_if<Manipulator>(&robot);
  if (manipulator == nullptr) return;
  const std::size_t num_joints = manipulator->joints.size();
  checkCount("joints", num_joints, 1, kMaxJoints);
  checkCount("sensors", manipulator->sensors.size(), 1, kMaxRobotSensors);
  checkFields("", kDriveFields, manipulator->drive);
  for (std::size_t j = 0; j < num_joints; ++j) checkJoint(elementOf("joints", j), manipulator->joints[j], manipulator->drive);
  for (std::size_t s = 0; s < manipulator->sensors.size(); ++s) checkSensor(elementOf("sensors", s), manipulator->sensors[s], num_joints);
  checkPose("base", manipulator->X_WB);
  const auto& selection = manipulator->selection;
  if (std::find(selection.begin(), selection.end(), true) == selection.end()) {
    failField("selection", "an empty list", "at least one of vx, vy, vz, wx, wy, wz");
  }
  checkFields("", kManipulatorFields, *manipulator);
}

}  // namespace taxelsim
