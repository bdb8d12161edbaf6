#include <cmath>

#include "base/field_checks.h"
#include "control/robot_fields.h"

namespace taxelsim {
namespace {

// Rotates z of the joint frame, which is the axis of the joint, to y of the link.
const Quaternion kRotationZToY{std::sqrt(0.5), -std::sqrt(0.5), 0, 0};

}  // namespace

Manipulator panTilt(const PanTilt& platform) {
  checkFields("", kPanTiltFields, platform);
  const auto [lower, upper] = platform.position_limits;
  if (lower > upper)
    failField("position_limits", "[" + numberText(lower) + ", " + numberText(upper) + "] rad", "[min, max] with min <= max");
  Manipulator robot;
  robot.name = "pan_tilt";
  robot.selection = {false, false, false, false, true, true};
  robot.drive = platform.drive;
  for (const char* name : {"pan", "tilt"}) {
    robot.joints.push_back({.name = name,
                            .type = JointType::kRevolute,
                            .lower = platform.position_limits[0],
                            .upper = platform.position_limits[1],
                            .max_velocity = platform.max_velocity});
  }
  const ChainJoint pan{.X_PJ = {}, .type = JointType::kRevolute, .joint = 0};
  const ChainJoint tilt{.X_PJ = {{0, 0, platform.tilt_height}, kRotationZToY}, .type = JointType::kRevolute, .joint = 1};
  const Pose X_JL = inverse({{0, 0, 0}, kRotationZToY});  // the tilt link in the frame of its joint
  for (const SensorMount& mount : platform.sensors) {
    if (mount.link == "base") {
      robot.sensors.push_back({mount.link, {}, mount.X_LS});
    } else if (mount.link == "pan") {
      robot.sensors.push_back({mount.link, {pan}, mount.X_LS});
    } else if (mount.link == "tilt") {
      robot.sensors.push_back({mount.link, {pan, tilt}, X_JL * mount.X_LS});
    } else {
      throw Error(ErrorKind::kInput, "no link " + mount.link + ": allowed are base, pan and tilt");
    }
  }
  checkRobot(robot);
  return robot;
}

}  // namespace taxelsim
