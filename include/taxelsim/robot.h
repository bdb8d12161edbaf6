// Robots that carry sensors, as data: kinematics, limits, what drives the joints. Not dynamics, and not running robots: those belong to the
// scheduler. B is a robot's base, L a link, S a sensor.
#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "taxelsim/pose.h"

namespace taxelsim {

inline constexpr int kMaxJoints = 32;        // of a robot
inline constexpr int kMaxRobotSensors = 64;  // of a robot
inline constexpr int kMaxChainJoints = 64;   // on the way to a sensor, mimic joints among them
inline constexpr int kMaxDelayTicks = 1000;

// The sensor goes wherever its twist takes it.
struct FreeFlying {};

enum class JointType { kRevolute, kPrismatic };

// A degree of freedom. Units: rad and rad/s, or m and m/s of a prismatic joint.
struct Joint {
  std::string name;
  JointType type = JointType::kRevolute;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  double max_velocity = std::numeric_limits<double>::infinity();  // > 0
  double initial_position = 0;                                    // lower to upper
};

// A joint on the way from the base to a sensor: about or along z of its own frame J, which at position 0 has the pose X_PJ in the frame
// that moves with the joint before (of the first: in B).
struct ChainJoint {
  Pose X_PJ = {};
  JointType type = JointType::kRevolute;
  int joint = 0;          // the index of the degree of freedom q that moves it,
  double multiplier = 1;  // to the position multiplier q + offset: 1 and 0 but for mimic joints
  double offset = 0;
};

struct MountedSensor {
  std::string link;
  std::vector<ChainJoint> chain = {};
  Pose X_JS = {};  // in the frame that moves with the last joint; in B where the chain is empty
};

// What stands between a joint's command and the joint. The command itself is never rounded: increments below a step add up.
struct JointDrive {
  double position_step = 0;  // rad or m, >= 0: the joint goes to the multiple of it next to the command; 0: to the command
  int delay = 0;             // ticks from a command to the joint, 0 to kMaxDelayTicks
};

// A robot with joints. Twists become joint velocities by damped least squares (Y. Nakamura, H. Hanafusa, "Inverse kinematic solutions with
// singularity robustness for robot manipulator control", J. Dyn. Sys. Meas. Control 108, 1986; A. A. Maciejewski, C. A. Klein, "Numerical
// filtering for the operation of robotic manipulators through kinematically singular configurations", J. Robotic Systems 5, 1988): with
// sigma the smallest singular value of the selected rows of the Jacobian (m/s and rad/s per rad/s or m/s, in S),
//
//   minimise |J q' - twist|^2 + lambda^2 |q'|^2,  lambda^2 = max_damping^2 (1 - (sigma / singular_threshold)^2) where sigma is below the
//                                                 threshold, else 0
//
// the damping of S. Chiaverini, B. Siciliano, O. Egeland, IEEE Trans. Control Systems Technology 2, 1994.
struct Manipulator {
  std::string name;
  std::vector<Joint> joints;           // 1 to kMaxJoints
  std::vector<MountedSensor> sensors;  // 1 to kMaxRobotSensors; the twists are those of the first
  Pose X_WB = {};
  std::array<bool, 6> selection{true, true, true, true, true, true};  // of v along x, y, z and w about x, y, z of S: what is followed
  double max_damping = 0.05;                                          // > 0
  double singular_threshold = 0.05;                                   // > 0 to 1
  JointDrive drive = {};
};

using Robot = std::variant<FreeFlying, Manipulator>;

// Throws Error(kInput): the field, the value found and what is allowed.
void checkRobot(const Robot& robot);

// A sensor's place: on a link, by name, with its pose X_LS there.
struct SensorMount {
  std::string link;
  Pose X_LS = {};
};

// Two Dynamixel AX-12 under a plate, as the platform of Kappassov, Corrales and Perdereau (AIM 2020) section V.B: `pan` about z of B, and
// on it `tilt` about y, at `tilt_height` above the base. Links: base, pan, tilt; at rest all have the axes of B. Servo data: ROBOTIS
// e-manual, AX-12A. Its lengths are not published; the defaults are assumptions.
struct PanTilt {
  double tilt_height = 0.05;  // m
  std::vector<SensorMount> sensors{{"tilt", {{0, 0, 0.03}, {1, 0, 0, 0}}}};
  std::array<double, 2> position_limits{-150 * std::numbers::pi / 180, 150 * std::numbers::pi / 180};  // rad; 300 deg of range
  double max_velocity = 59 * std::numbers::pi / 30;                                                    // rad/s; 59 rpm without load at 12 V
  JointDrive drive{.position_step = 0.29 * std::numbers::pi / 180, .delay = 0};                        // 0.29 deg
};

// Follows w about y and z of S: tilt and pan. Throws Error(kInput) as checkRobot() does, and for an unknown link.
Manipulator panTilt(const PanTilt& platform);

inline constexpr std::uintmax_t kMaxRobotFileBytes = std::uintmax_t{16} << 20;

struct UrdfOptions {
  std::string base_link;             // stands at X_WB; the root when empty
  std::vector<SensorMount> sensors;  // at least one
  double velocity_limit_scale = 1;   // > 0 to 1, times the velocity limits of the file
};

// The chains of a URDF file from a base to the links with sensors: revolute, continuous, prismatic and fixed joints; mimic joints follow
// theirs, with their own limits mapped to it. Masses and shapes are not read. Joints stand at 0, or at the limit next to it. Throws
// Error(kInput), the file and one line, for a file that is missing, malformed, no tree, or wrong on the way to a sensor.
Manipulator loadUrdf(const std::filesystem::path& file, const UrdfOptions& options);

}  // namespace taxelsim
