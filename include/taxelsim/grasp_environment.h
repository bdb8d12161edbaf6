/// @file
/// A batch of grasps whose joints the caller moves: reset, observe, act, step, judge. The Environment of a scene of kind grasp.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "taxelsim/environment.h"
#include "taxelsim/scene.h"
#include "taxelsim/verdict.h"

namespace taxelsim {

/// The latest frame of one sensor of a hand. Sensors with equal settings share a frame.
struct GraspSensorView {
  const RobotSensor* sensor = nullptr;  ///< The sensor, in the scene.
  const FrameView* frame = nullptr;     ///< Rows of all instances of all sensors that share it.
  std::size_t num_rows = 0;             ///< Rows of the frame.
  std::size_t first_row = 0;            ///< Row of instance 0; that of instance i is first_row + i * num_rows / N.
};

/// The latest frame of every instance and the state of its episode. N = num_instances; W is the world.
struct GraspView {
  std::vector<GraspSensorView> sensors;        ///< (num_sensors), in the order of the robot.
  std::span<const std::uint64_t> episodes;     ///< (N), number of the episode.
  std::span<const int> frame_numbers;          ///< (N), 0 to num_frames - 1; larger after the end of the episode.
  double dt = 0;                               ///< s, from one frame to the next.
  std::span<const Pose> X_WO;                  ///< (N x num_objects), pose of each object.
  std::span<const Pose> X_WS;                  ///< (N x num_sensors), pose of each sensor.
  std::span<const double> joint_positions;     ///< (N x num_joints), rad or m.
  std::span<const double> joint_velocities;    ///< (N x num_joints), rad/s or m/s, of the joints, not of their commands.
  std::span<const std::uint8_t> robot_status;  ///< (N), what limited the latest motion; bits as Verdict::robot.
  std::span<const double> target_forces;       ///< (N x num_fingers), N, force that each finger must hold.
};

/// State of the fingers at the latest frame, by clean forces. N = num_instances.
struct GraspState {
  std::span<const double> forces;                 ///< (N x num_fingers), N, total force.
  std::span<const double> peak_forces;            ///< (N x num_fingers), N, largest force so far.
  std::span<const int> num_losses;                ///< (N x num_fingers), times that contact was lost so far.
  std::span<const std::uint8_t> were_in_contact;  ///< (N x num_fingers), 1: the finger has touched in this episode.
};

/// A batch of instances that run episodes of a scene of kind grasp. generate() and evaluateGrasp() give the same frames for the same joint
/// velocities, bit for bit, whatever the number of instances.
///
/// reset(), then in a loop: observe(), step(). An episode is a function of the scene, its number and the velocities alone. The law that
/// closes fingers and the servo of the scene do not act. Errors and threads: as of Environment.
class GraspEnvironment {
 public:
  /// Copies `scene`. Throws Error(kInput) for a scene of another kind, and what Model and Simulator throw.
  GraspEnvironment(const Device& device, const Scene& scene, const EnvironmentOptions& options);
  ~GraspEnvironment();
  GraspEnvironment(GraspEnvironment&&) noexcept;             ///< Moves the batch.
  GraspEnvironment& operator=(GraspEnvironment&&) noexcept;  ///< Moves the batch.

  int numInstances() const;    ///< N.
  int numJoints() const;       ///< Joints per robot.
  int numFrames() const;       ///< Frames per episode.
  double dt() const;           ///< s, from one frame to the next.
  int controlPeriod() const;   ///< Frames from one action to the next, by Scene::control_rate.
  const Scene& scene() const;  ///< The scene; valid as long as the environment.

  /// Starts episode episodes[i] on every instance i with mask[i] != 0 and computes its frame 0. `mask`, `episodes` (N).
  ///
  /// All other instances stay as they are, bit for bit. Waits.
  void reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> episodes);

  /// The latest frame. The spans stay valid until the next step() or reset(), or the end of the environment.
  GraspView observe() const;

  /// Moves the joints by `velocities` (N x num_joints; rad/s or m/s) for `num_frames` frames. Waits for the last one.
  ///
  /// Velocities beyond a limit are reduced (robot_status); a joint stops at its position limit. Throws Error(kInput), which names the
  /// instance, if a value is not finite; nothing moves then. After the last frame of an episode its verdict stays as it is.
  void step(std::span<const double> velocities, int num_frames = 1);
  /// The same with the velocities of the latest step(); 0 after a reset().
  void advance(int num_frames);

  /// State of the fingers at the latest frame. The spans stay valid as those of observe().
  GraspState state() const;

  /// Verdict on the latest episode of an instance, up to the latest frame; a success only once the last frame has been computed.
  GraspVerdict judge(int instance) const;

  /// @cond
  struct Impl;
  /// @endcond

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim
