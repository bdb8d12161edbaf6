// Instances that run episodes: a simulator, robots and objects. Knows no controller and no sink: the caller commands the robots and reads
// the frames.
//
// An episode on an instance:
//
//   frame 0           The object is placed on the robot's sensor 0: load-driven (the device searches the depth) or at a given depth. If the
//                     robot has more sensors and the start is load-driven, a warm-up frame (-1) runs first: the other sensors need the pose
//                     at which the object came to rest. The instance is not active in a warm-up frame.
//   frames 1, 2, ...  The object rests in the world or follows its trajectory; the robot moves the sensors by the latest action.
//
//   start -> setInputs, submit -> read, beginFrame: initialContact (first frame only) -> act (at control ticks) -> advance -> setInputs,
//   ...
//
// The content of an episode does not depend on the instance that runs it, nor on when. Not thread-safe: one thread at a time.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/thread_team.h"
#include "control/robots.h"
#include "episodes/frame_context.h"
#include "episodes/plan.h"
#include "simulation/servo_loop.h"
#include "taxelsim/simulator.h"
#include "taxelsim/trajectory.h"

namespace taxelsim {

class EpisodeBatch {
 public:
  // All instances are idle. `loops`: the servos that command all instances, if the device closes their loops; then neither act() nor
  // computeFirstFrames() may be called, and X_SO() and robots() stay at the start. Throws what Simulator throws. `plan` must outlive this.
  EpisodeBatch(const Model& model, const EpisodePlan& plan, int num_instances, const std::optional<ServoLoopPlan>& loops = {});

  // Starts an episode on an instance: the next submitted frame is its first. `draw`: plan.drawer.draw(episode).
  void start(int i, std::uint64_t episode, const EpisodeDraw& draw);
  // Makes an instance idle.
  void stop(int i);
  // Compiles the kernels of all frames. Call once the first episodes have started. Waits.
  void prepare();

  // Passes poses and loads, or recorded contact points, to the simulator.
  void setInputs();
  // Submits the next frame; does not wait.
  void submit() { simulator_.step(plan_.dt); }
  // Waits for the submitted frame.
  void read();
  // Updates the episodes by the frame that was read; after it, the accessors describe that frame.
  void beginFrame();

  // Computes frame 0 of the instances with instances[i] != 0 (num_instances), which must all have started since their last frame. The
  // frames and states of all other instances stay as they are. After it, the accessors describe the latest frame of every instance. Waits.
  void computeFirstFrames(std::span<const std::uint8_t> instances);

  // Takes the twists (num_instances) of sensor 0 in S for the instances whose control tick is due, and adds the scene's action noise. The
  // robot keeps it until the instance's next tick. Robots do not move for values that are not finite (RobotStatus::kLost).
  void act(std::span<const Twist> twists) { act(twists, 0, numInstances()); }
  // The same for the instances from `first` to before `last`. The threads of team() may act on parts that do not overlap.
  void act(std::span<const Twist> twists, int first, int last);
  // The same for joint velocities (num_instances x num_joints; rad/s or m/s) of a manipulator. Revolute joints have the scene's angular
  // action noise, prismatic joints the linear one.
  void actJoints(std::span<const double> velocities);
  // Throw Error(kInput) that names the instance and its episode, if an action that act() or actJoints() would take is not finite.
  // first_instance: added to the number of the instance in the message.
  void checkActions(std::span<const Twist> twists, int first_instance = 0) const;
  void checkJointActions(std::span<const double> velocities, int first_instance = 0) const;
  // Moves robots, then objects, to the next frame. Instances whose last frame was read have ended and become idle.
  void advance();
  // The two halves of advance(), in this order.
  void moveRobots();
  void moveObjects();

  // The loops that the device closes; null if there are none.
  ServoLoop* deviceLoop() { return loop_ ? &*loop_ : nullptr; }

  // Threads that share loops over the instances. The results do not depend on their number.
  ThreadTeam& team() { return team_; }

  int numInstances() const { return robots_.numInstances(); }
  bool busy() const { return num_busy_ > 0; }  // whether any instance runs an episode

  const EpisodePlan& plan() const { return plan_; }
  const FrameView& frame() const { return frame_; }  // rows: num_instances x num_sensors
  FrameContext context() const;
  const Robots& robots() const { return robots_; }
  std::span<const std::uint8_t> active() const { return active_; }           // (num_instances), 1: the frame belongs to an episode
  std::span<const std::uint8_t> controlDue() const { return control_due_; }  // (num_instances)
  std::span<const int> frameNumbers() const { return frame_numbers_; }       // (num_instances), from 0; -1 in a warm-up frame
  std::span<const double> times() const { return times_; }                   // (num_instances), s
  std::span<const std::uint64_t> episodes() const { return episodes_; }      // (num_instances)
  std::span<const int> objects() const { return objects_; }  // (num_instances), index into the scene's objects, or kNoObject
  std::span<const std::uint8_t> loadReached() const { return load_reached_; }  // (num_instances)
  std::span<const float> startForces() const { return start_forces_; }         // (num_instances), N, of the first frame
  std::span<const Pose> X_SO() const { return X_SO_; }                         // (num_instances x num_sensors)
  std::span<const Pose> X_WO() const { return X_WO_; }                         // (num_instances)
  bool hasEnded(int i) const { return ended_[i] != 0; }                        // in the latest advance()
  const EpisodeDraw& draw(int i) const { return states_[i].draw; }
  // Constants of the episode without those of its controller. Valid from its frame 0 on.
  EpisodeRecord record(int i) const;
  Simulator& simulator() { return simulator_; }
  DeviceTraffic traffic() const { return simulator_.traffic(); }
  double timeOfFrame() const { return simulator_.timing().total; }  // s, device time; NaN unless plan.device_clock

 private:
  // What an episode needs in every frame, as bits.
  enum EpisodeFlag : std::uint8_t {
    kWarmsUp = 1,      // the first frame is -1
    kMounted = 2,      // X_NS is not the identity
    kMoves = 4,        // the object has a trajectory
    kActionNoise = 8,  // actions get noise
  };
  // What the device has to be given before the next frame, as bits, where it closes the loops.
  enum Change : std::uint8_t { kObjectChanged = 1, kLoadChanged = 2 };
  // State of the episode that an instance runs. Large, so that frames read it only where a flag says so.
  struct EpisodeState {
    EpisodeDraw draw;
    Pose X_NS;                             // of the sensors in the frame where the robot believes them; with kMounted
    double load_offset = 0;                // m
    std::optional<Trajectory> trajectory;  // of a moving object, from its initial contact
  };

  void setChangedInputs();
  void setContacts(const ContactRecording& recording);
  bool has(int i, EpisodeFlag flag) const { return (flags_[i] & flag) != 0; }
  Pose inSensor(int i, const Pose& X_NO) const;
  void resetSensors(int i);
  void initialContact(int i);
  void beginFrame(int i);
  void nextFrame(int i);
  void continueEpisode(int i);
  void updatePoses(int i);
  void computeFrames(std::span<const std::uint8_t> instances);
  double actionNoise(int i, std::uint32_t component, double deviation) const;

  const EpisodePlan& plan_;
  Simulator simulator_;
  std::optional<ServoLoop> loop_;
  Robots robots_;
  ThreadTeam& team_;  // of the simulator
  FrameView frame_;
  int num_busy_ = 0;
  bool loads_changed_ = false;

  // (num_instances x num_sensors)
  std::vector<int> ids_;
  std::vector<Pose> X_SO_;
  std::vector<float> loads_;
  std::vector<ContactPoint> contacts_;  // of all instances, in their order
  std::vector<int> offsets_;            // (num_instances + 1)
  std::vector<std::uint8_t> computed_;  // 1: the instance of the simulator is computed by computeFrames()

  // (num_instances)
  std::vector<EpisodeState> states_;
  std::vector<std::uint8_t> flags_;    // bits of EpisodeFlag
  std::vector<std::uint8_t> changes_;  // bits of Change
  std::vector<std::uint64_t> episodes_;
  std::vector<int> objects_;
  std::vector<std::uint8_t> load_reached_;
  std::vector<std::uint8_t> busy_;
  std::vector<std::uint8_t> active_;  // busy, and not in a warm-up frame
  std::vector<std::uint8_t> ended_;
  std::vector<std::uint8_t> control_due_;
  std::vector<int> frame_numbers_;
  std::vector<double> times_;
  std::vector<Pose> X_WO_;               // W: the frame of sensor 0 at the start of the episode
  std::vector<Twist> twists_;            // commanded; those of joint velocities by the Jacobian
  std::vector<Twist> actions_;           // with action noise
  std::vector<std::uint8_t> by_joints_;  // 1: the robot follows joint_actions_ instead of actions_
  std::vector<double> joint_actions_;    // x num_joints, with action noise
  std::vector<float> start_forces_;
};

}  // namespace taxelsim
