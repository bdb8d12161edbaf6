/// @file
/// A batch of episodes whose actions the caller chooses: reset, observe, act, step, judge. Not an environment of Gymnasium: it has no
/// spaces, rewards or automatic resets.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "taxelsim/model.h"
#include "taxelsim/pose.h"
#include "taxelsim/scene.h"
#include "taxelsim/simulator.h"
#include "taxelsim/verdict.h"

namespace taxelsim {

/// Options of an Environment.
struct EnvironmentOptions {
  int num_instances = 1;  ///< N, instances of the batch, 1 to what device memory holds.
  /// Optional outputs in EnvironmentView::frame. Default: none.
  OutputOptions outputs = kNoOutputs;
  int max_regions = 0;  ///< Rows of contact features for regions, 0 to kMaxRegions; 0 without such features.
  /// As SimulatorOptions::export_memory. The host still gets the features that episodes and judgements need.
  bool export_memory = false;
};

/// The latest frame of every instance and the state of its episode. N = num_instances; S is the sensor, W the frame of sensor 0 at the
/// start of the episode. Rows of an instance that is not active are undefined.
struct EnvironmentView {
  FrameView frame;                             ///< Outputs of the sensors; num_sensors rows per instance.
  std::span<const std::uint8_t> active;        ///< (N), 1: the instance runs an episode, and this frame belongs to it.
  std::span<const std::uint8_t> control_due;   ///< (N), 1: control tick, at which the instance takes an action.
  std::span<const std::uint64_t> episodes;     ///< (N), number of the episode.
  std::span<const int> frame_numbers;          ///< (N), 0 to num_frames - 1.
  std::span<const double> times;               ///< (N), s since frame 0.
  std::span<const int> objects;                ///< (N), index into Scene::objects.
  std::span<const std::uint8_t> load_reached;  ///< (N), 0: the skin could not carry the load at the start, so the deepest contact is taken.
  std::span<const float> start_force;          ///< (N), N: drawn load, or the measured force of frame 0 if the start is depth-driven.
  std::span<const Pose> X_SO;                  ///< (N x num_sensors), pose of the object in each sensor.
  std::span<const Pose> X_WO;                  ///< (N), pose of the object.
  std::span<const Pose> X_WS;                  ///< (N x num_sensors), pose of each sensor.
  std::span<const double> joint_positions;     ///< (N x num_joints), rad or m.
  std::span<const double> joint_velocities;    ///< (N x num_joints), rad/s or m/s, of the joints, not of their commands.
  std::span<const std::uint8_t> robot_status;  ///< (N), what limited the latest motion; bits as Verdict::robot.
};

/// State of the task at the latest frame of every instance, from ground truth. Rows of an instance that has run no episode are undefined.
struct TaskState {
  /// (N x kNumTaskMeasures), in the units of TaskMeasure, >= 0. NaN: the task has no such criterion. Infinite: undefined, as without
  /// contact.
  std::span<const double> errors;
  std::span<const std::uint8_t> within;   ///< (N), 1: in contact, and all errors are within their tolerances.
  std::span<const std::uint8_t> contact;  ///< (N), 1: the clean total force is above 0.
  std::span<const float> travel;          ///< (N), Verdict::travel so far.
  std::span<const float> laps;            ///< (N), Verdict::laps so far.
  std::span<const float> peak_force;      ///< (N), Verdict::peak_force so far.
  std::span<const int> num_losses;        ///< (N), Verdict::num_losses so far.
};

/// Options of the model that a scene needs: its sensor and its objects.
ModelOptions modelOptionsOf(const Scene& scene);

/// Number of an episode for one reset of one instance: a hash (Philox4x32-10, key `seed`, counter `instance` and `num_resets`). Independent
/// of the number of instances.
std::uint64_t episodeKey(std::uint64_t seed, std::uint32_t instance, std::uint64_t num_resets);

/// A batch of instances that run episodes of a scene. generate() and evaluate() give the same frames for the same actions, bit for bit,
/// whatever the number of instances.
///
/// reset(), then in a loop: observe(), act() at control ticks, step(). An episode is a function of the scene, its number and the actions
/// alone. An instance whose episode has ended is not active until its next reset().
///
/// Errors: wrong lengths and values throw Error(kInput) and change nothing; calls before the first reset() throw std::logic_error; a lost
/// device throws Error(kDevice), after which the environment is unusable. Threads: one thread at a time; environments of one Model may run
/// in different threads.
class Environment {
 public:
  /// No instance is active. Copies `scene`, of kind kServo. `model`: Model(device, modelOptionsOf(scene)); the names of its sensor and its
  /// objects may differ. Throws Error(kInput) for another kind, sensor or object, and what Simulator throws.
  Environment(const Model& model, const Scene& scene, const EnvironmentOptions& options);
  /// The same with a model of its own. Throws what Model throws as well.
  Environment(const Device& device, const Scene& scene, const EnvironmentOptions& options);
  ~Environment();
  Environment(Environment&&) noexcept;             ///< Moves the batch.
  Environment& operator=(Environment&&) noexcept;  ///< Moves the batch.

  int numInstances() const;    ///< N.
  int numSensors() const;      ///< Sensors per robot. Sensor 0 is the one that twists command.
  int numJoints() const;       ///< Joints per robot; 0 for FreeFlying.
  int numFrames() const;       ///< Frames per episode.
  int controlPeriod() const;   ///< Frames from one control tick to the next.
  double dt() const;           ///< s, from one frame to the next.
  const Scene& scene() const;  ///< The scene; valid as long as the environment.
  const Model& model() const;  ///< The model; valid as long as the environment.
  /// The batch, of num_sensors instances for each of the environment: for exportOutputs() and the order of consumers alone.
  Simulator& simulator();

  /// Starts episode episodes[i] on every instance i with mask[i] != 0 and computes its frame 0, with load search. `mask`, `episodes` (N).
  ///
  /// The frames, clocks and states of all other instances stay as they are, bit for bit. An unfinished episode is abandoned. Throws
  /// Error(kInput) if an object has no lowest point in its drawn orientation. Waits.
  void reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> episodes);

  /// The latest frame. Waits for it. The spans stay valid until the next step() or reset(), or the end of the environment.
  EnvironmentView observe();

  /// Commands the twist twists[i] (N) of sensor 0, in S, to the active instances whose control tick is due; the other rows are ignored.
  ///
  /// A robot follows its action until the instance's next one; it rests before the first. The scene's action noise is added. A second call
  /// in the same frame replaces the first. Throws Error(kInput) that names the instance if a value is not finite. Waits for the latest
  /// frame.
  void act(std::span<const Twist> twists);
  /// The same for joint velocities (N x num_joints; rad/s or m/s) of a manipulator. Those beyond a limit are reduced (robot_status).
  ///
  /// Revolute joints have the scene's angular action noise, prismatic joints the linear one. Throws Error(kInput) for FreeFlying as well.
  void actJoints(std::span<const double> velocities);

  /// Moves robots and objects by dt() and submits the next frame. An episode ends with the step() after its last frame. Waits for the
  /// latest frame, if it has not been observed; does not wait for the next one.
  void step();

  /// State of the task at the latest frame. Waits for it. The spans stay valid as those of observe(). Throws Error(kInput) for a scene
  /// without a task.
  TaskState taskState();

  /// Verdict on the latest episode of an instance, up to the latest frame. Waits for it.
  ///
  /// A success only once the last frame has been computed; stays until the next reset() of the instance. Throws Error(kInput) for a scene
  /// without a task, and std::logic_error if the instance has run no episode.
  Verdict judge(int instance);

  /// @cond
  struct Impl;
  /// @endcond

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim
