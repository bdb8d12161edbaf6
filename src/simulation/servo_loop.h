// Closed loops of sensors, free-flying or on a robot, that the device closes. After the passes of a frame, servo.comp commands each sensor
// by the features, moves it, and writes the pose of its object for the next frame, with the bits that TactileServoController, Robots and
// Simulator::setObjects() give. Poses and features then need not cross the bus.
//
// An instance whose objects are set runs an episode from the next step on, after start(); its other steps take the pose that the device has
// computed.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "taxelsim/control.h"
#include "taxelsim/pose.h"
#include "taxelsim/robot.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// What the host reads after every frame.
struct LoopOutputs {
  bool tactile_image = true;
  bool object_poses = true;
  bool sensor_poses = true;
  bool actions = true;
  bool robot_status = true;
  bool joints = true;  // positions and velocities
};

// A manipulator with one sensor, and its state at the start of every episode.
struct LoopRobot {
  Manipulator robot;
  Pose X_WB, X_WS;
  std::vector<double> positions, commands;  // (num_joints)
  std::vector<double> jacobian;             // (num_joints x 6), as Chain::poseAt()
};

// What all loops of a batch have in common.
struct ServoLoopPlan {
  std::vector<TactileServo> servos;     // with a nominal Jacobian and a measured edge angle
  double dt = 0;                        // s, step of the simulation
  int control_period = 1;               // steps
  bool starts_at_load = false;          // whether LoopStart::start_force replaces the total force of the first frame
  bool reads_contact_features = false;  // whether servos read contact features, which the simulator must output
  LoopOutputs outputs;
  std::optional<LoopRobot> robot;  // empty: sensors are free-flying

  int numJoints() const { return robot ? static_cast<int>(robot->robot.joints.size()) : 0; }
};

struct LoopStart {
  int object = 0;
  Pose X_WO;                        // before the load search; W is the frame of the sensor at the start
  int servo = 0;                    // number in ServoLoopPlan::servos
  double exploration_velocity = 0;  // m/s
  float start_force = 0;            // N
};

// A simulator of one slot and its loops. Not thread-safe.
class ServoLoop {
 public:
  // Whether the device has the arithmetic.
  static bool isSupported(const Model& model);
  // Whether the device runs the loops faster than the host.
  static bool isFaster(const Model& model);

  static MemoryPlan planMemory(const Model& model, const SimulatorOptions& options, const ServoLoopPlan& plan);

  // `simulator`, made with BatchOptions::loop, must outlive this.
  explicit ServoLoop(Simulator& simulator);

  int numInstances() const { return num_instances_; }

  // The next step of the instance is the first one of an episode; its object and load must be set as well.
  void start(int instance, const LoopStart& start);
  void stop(int instance);

  // After Simulator::read().
  void read();
  // Of the frame that was read; undefined for instances without an episode; empty unless an output.
  std::span<const Pose> X_SO() const;
  std::span<const Pose> X_WS() const;
  std::span<const Twist> actions() const;                           // after the frame
  std::span<const double> jointPositions() const;                   // (num_instances x num_joints)
  std::span<const double> jointVelocities() const;                  // likewise
  std::span<const std::uint8_t> status() const { return status_; }  // flags of RobotStatus, of the motion that led to the frame

 private:
  Simulator::Impl& simulator_;
  int num_instances_;
  std::vector<std::uint8_t> status_;
};

}  // namespace taxelsim
