/// @file
/// Grasps: a robot with several named sensors, each with its own sensor file, whose fingers close until each reads its target force.
/// Part of a Scene of kind grasp. Objects move as prescribed; contact does not act back on them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "taxelsim/control.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

/// A sensor of a robot. Mounts are in Manipulator::sensors, in the same order.
struct RobotSensor {
  std::string name;  ///< Group of its columns in data sets: letters, digits and _; unique.
  Sensor sensor;     ///< The sensor.
  std::string text;  ///< The sensor as canonical YAML: sensors with the same text share a Model.
};

/// A joint of a finger.
struct FingerJoint {
  int joint = 0;        ///< Index into Manipulator::joints.
  double velocity = 0;  ///< rad/s or m/s, not 0: its velocity while the finger closes at full speed.
};

/// A finger: joints that close together, and the sensor whose force they control.
struct GraspFinger {
  int sensor = 0;                   ///< Index into Grasp::sensors.
  double force = 1;                 ///< N, > 0: target of the measured total force.
  std::vector<FingerJoint> joints;  ///< At least one; a joint belongs to one finger.
};

/// A tactile servo of one sensor, which moves joints that belong to no finger: an arm that carries the hand. It runs in every frame.
struct GraspServo {
  int sensor = 0;                    ///< Index into Grasp::sensors; the sensor of no finger.
  std::vector<int> joints;           ///< Indices into Manipulator::joints, at least one: joints that move the sensor.
  TactileServo servo = edgeServo();  ///< Its parameters. Not EdgeAngleSource::kExact. The force at the start is that of the first frame.
};

/// What a grasp must achieve. An episode succeeds if every finger holds: in every frame of the last `hold` seconds its clean total force is
/// within `tolerance` of its target, and its clean centre of pressure within `drift` of where it was when they began.
struct GraspTask {
  double tolerance = 0.1;         ///< Fraction of the target, > 0 to 1. Default 0.1.
  double hold = 0.5;              ///< s, > 0, at most the duration of the episode. Default 0.5, or the duration if that is shorter.
  std::optional<double> drift{};  ///< m, > 0, in the xy plane of S. Default: not judged.
};

/// The grasp of a scene.
///
/// In every frame each finger moves its joints at s times their closing velocities, with
///
///     s = clamp((gain (F* - F) - T J a') / (dF/ds), -1, 1),    dF/ds = T J q'
///
/// F is the measured total force, F* its target, T the measured tactile Jacobian of the total force (1 x 6), J the Jacobian of the sensor
/// by the joints, q' the closing velocities, and a' the velocities that the servo commands in this frame (0 without one): the finger
/// compensates the motion of the arm. Where dF/ds is not positive, as without contact, s is the sign of F* - F. The error of a contact of
/// constant stiffness decays by the factor 1 - gain / simulation_rate per frame.
struct Grasp {
  std::vector<RobotSensor> sensors;  ///< Sensors of the robot.
  std::vector<GraspFinger> fingers;  ///< At least one.
  std::optional<GraspServo> servo;   ///< Default: no joint moves but those of fingers.
  GraspTask task{};                  ///< What `evaluate` judges.
  double gain = 10;                  ///< 1/s, > 0 to simulation_rate. Default 10.
  double offset = 0;                 ///< m, >= 0: each object starts displaced uniformly by up to this along x, y and z of W. Default 0.
  double yaw = 0;                    ///< rad, >= 0: and rotated by up to this about the z axis of W through its origin. Default 0.
  double force_spread = 0;           ///< 0 to 1: targets of an episode are multiplied by a factor within 1 +- this. Default 0.
};

}  // namespace taxelsim
