/// @file
/// Robots that carry sensors: kinematics, limits and drives as data. No dynamics. B is the frame of a robot's base, L of a link, S of a
/// sensor.
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

inline constexpr int kMaxJoints = 32;        ///< Largest number of degrees of freedom of a robot.
inline constexpr int kMaxRobotSensors = 64;  ///< Largest number of sensors of a robot.
inline constexpr int kMaxChainJoints = 64;   ///< Largest number of joints between base and sensor, mimic joints included.
inline constexpr int kMaxDelayTicks = 1000;  ///< Largest JointDrive::delay.

/// No robot: the sensor moves by its commanded twist.
struct FreeFlying {};

/// Kind of joint.
enum class JointType {
  kRevolute,   ///< Rotates about z of its frame; rad and rad/s.
  kPrismatic,  ///< Translates along z of its frame; m and m/s.
};

/// A degree of freedom. Units follow its type.
struct Joint {
  std::string name;                                               ///< Name in URDF files and data sets.
  JointType type = JointType::kRevolute;                          ///< Kind of joint.
  double lower = -std::numeric_limits<double>::infinity();        ///< Lower position limit.
  double upper = std::numeric_limits<double>::infinity();         ///< Upper position limit.
  double max_velocity = std::numeric_limits<double>::infinity();  ///< Velocity limit, > 0.
  double initial_position = 0;                                    ///< Position at the start of an episode, lower to upper.
};

/// A joint of the chain from the base to a sensor. Its position is multiplier q + offset, with q the position of a degree of freedom.
struct ChainJoint {
  Pose X_PJ = {};                         ///< Pose of the joint at position 0, in the moving frame of the previous joint; the first in B.
  JointType type = JointType::kRevolute;  ///< Kind of joint.
  int joint = 0;                          ///< Index into Manipulator::joints of the degree of freedom q.
  double multiplier = 1;                  ///< 1 except for mimic joints.
  double offset = 0;                      ///< 0 except for mimic joints.
};

/// A sensor on a robot.
struct MountedSensor {
  std::string link;                    ///< Name of the link that carries it.
  std::vector<ChainJoint> chain = {};  ///< Joints from the base to the link.
  Pose X_JS = {};                      ///< Pose in the moving frame of the last joint, or in B if the chain is empty.
};

/// Quantisation and delay between the command of a joint and its position. The command itself is not rounded, so increments below a step
/// add up.
struct JointDrive {
  double position_step = 0;  ///< rad or m, >= 0: the joint moves to the multiple of it nearest to the command; 0 (default): to the command.
  int delay = 0;             ///< Simulation steps from a command to the joint, 0 to kMaxDelayTicks. Default 0.
};

/// A robot with joints. Twists become joint velocities by damped least squares.
///
/// With J the selected rows of the Jacobian (m/s and rad/s per rad/s or m/s, in S) and sigma its smallest singular value,
///
///     minimise |J q' - twist|^2 + lambda^2 |q'|^2
///     lambda^2 = max_damping^2 (1 - (sigma / singular_threshold)^2) if sigma < singular_threshold, else 0
///
/// after Y. Nakamura, H. Hanafusa, "Inverse kinematic solutions with singularity robustness for robot manipulator control", J. Dyn. Sys.
/// Meas. Control 108, 1986; A. A. Maciejewski, C. A. Klein, "Numerical filtering for the operation of robotic manipulators through
/// kinematically singular configurations", J. Robotic Systems 5, 1988. The damping is that of S. Chiaverini, B. Siciliano, O. Egeland, IEEE
/// Trans. Control Systems Technology 2, 1994.
struct Manipulator {
  std::string name;                                                   ///< Name in messages.
  std::vector<Joint> joints;                                          ///< Degrees of freedom, 1 to kMaxJoints.
  std::vector<MountedSensor> sensors;                                 ///< 1 to kMaxRobotSensors; twists are those of the first.
  Pose X_WB = {};                                                     ///< Pose of the base in the world.
  std::array<bool, 6> selection{true, true, true, true, true, true};  ///< Controlled components: v along x, y, z, w about x, y, z of S.
  double max_damping = 0.05;                                          ///< > 0.
  double singular_threshold = 0.05;                                   ///< > 0 to 1.
  JointDrive drive = {};                                              ///< Drive of all joints.
};

/// Any robot.
using Robot = std::variant<FreeFlying, Manipulator>;

/// Throws Error(kInput) with the field, the value found and what is allowed.
void checkRobot(const Robot& robot);

/// Place of a sensor on a robot.
struct SensorMount {
  std::string link;  ///< Name of the link.
  Pose X_LS = {};    ///< Pose on the link.
};

/// Pan-tilt platform: two Dynamixel AX-12 under a plate, as in section V.B of the paper.
///
/// `pan` rotates about z of B; on it `tilt` rotates about y, `tilt_height` above the base. Links: base, pan, tilt; at position 0 all have
/// the axes of B. Servo data: ROBOTIS e-manual, AX-12A. The lengths are not published; their defaults are assumptions.
struct PanTilt {
  double tilt_height = 0.05;                                                 ///< m, from the base to the tilt axis.
  std::vector<SensorMount> sensors{{"tilt", {{0, 0, 0.03}, {1, 0, 0, 0}}}};  ///< Sensors, at least one.
  /// rad, lower and upper limit of both joints: 300 deg of range.
  std::array<double, 2> position_limits{-150 * std::numbers::pi / 180, 150 * std::numbers::pi / 180};
  double max_velocity = 59 * std::numbers::pi / 30;    ///< rad/s: 59 rpm without load at 12 V.
  JointDrive drive{0.29 * std::numbers::pi / 180, 0};  ///< 0.29 deg.
};

/// The pan-tilt platform as a robot that follows w about y (tilt) and z (pan) of S. Throws what checkRobot() throws, and Error(kInput) for
/// an unknown link.
Manipulator panTilt(const PanTilt& platform);

/// Bytes of the largest URDF file that is read.
inline constexpr std::uintmax_t kMaxRobotFileBytes = std::uintmax_t{16} << 20;

/// Options of loadUrdf().
struct UrdfOptions {
  std::string base_link;             ///< Link at X_WB; empty (default): the root.
  std::vector<SensorMount> sensors;  ///< Sensors, at least one.
  double velocity_limit_scale = 1;   ///< > 0 to 1, multiplies the velocity limits of the file. Default 1.
};

/// Reads the kinematic chains from a base to the links with sensors of a URDF file.
///
/// Supports revolute, continuous, prismatic and fixed joints. Mimic joints follow their source; their own limits are mapped to it. Masses
/// and shapes are ignored. Initial positions are 0 or the nearest limit. Throws Error(kInput), one line that names the file, if it is
/// missing, malformed, not a tree, or invalid on a chain to a sensor.
Manipulator loadUrdf(const std::filesystem::path& file, const UrdfOptions& options);

}  // namespace taxelsim
