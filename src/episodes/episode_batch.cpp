#include "episodes/episode_batch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "base/philox.h"
#include "base/pose_inline.h"
#include "base/vector3.h"
#include "simulation/simulator_access.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

[[noreturn]] void refuseAction(int instance, std::uint64_t episode, const std::string& component, double value) {
  throw Error(ErrorKind::kInput, "action of instance " + std::to_string(instance) + " (episode " + std::to_string(episode) +
                                     "): " + component + " = " + std::to_string(value) + " is not allowed: finite");
}

}  // namespace

EpisodeBatch::EpisodeBatch(const Model& model, const EpisodePlan& plan, int num_instances, const std::optional<ServoLoopPlan>& loops)
    : plan_(plan),
      simulator_(SimulatorAccess::make(model, {plan.simulatorOptions(num_instances), loops, plan.host_threads})),
      robots_(plan.scene.robot, num_instances),
      team_(SimulatorAccess::team(simulator_)),
      ids_(num_instances * plan.num_sensors, kNoObject),
      X_SO_(num_instances * plan.num_sensors),
      loads_(num_instances * plan.num_sensors, kPoseDriven),
      computed_(num_instances * plan.num_sensors, 0),
      states_(num_instances),
      flags_(num_instances, 0),
      changes_(num_instances, 0),
      episodes_(num_instances, 0),
      objects_(num_instances, 0),
      load_reached_(num_instances, 1),
      busy_(num_instances, 0),
      active_(num_instances, 0),
      ended_(num_instances, 0),
      control_due_(num_instances, 0),
      frame_numbers_(num_instances, 0),
      times_(num_instances, 0.0),
      X_WO_(num_instances),
      twists_(num_instances),
      actions_(num_instances),
      by_joints_(num_instances, 0),
      joint_actions_(static_cast<std::size_t>(num_instances) * plan.num_joints),
      start_forces_(num_instances, 0.0f) {
  if (loops) loop_.emplace(simulator_);
}

void EpisodeBatch::stop(int i) {
  const int first = i * plan_.num_sensors;
  num_busy_ -= busy_[i];
  busy_[i] = active_[i] = control_due_[i] = by_joints_[i] = 0;
  robots_.reset(i, Pose{});
  if (loop_) loop_->stop(i);
  changes_[i] = kObjectChanged | kLoadChanged;
  loads_changed_ = true;
  loads_[first] = kPoseDriven;
  twists_[i] = actions_[i] = {};
  for (int s = first; s < first + plan_.num_sensors; ++s) {
    ids_[s] = kNoObject;
    X_SO_[s] = Pose{};
  }
}

void EpisodeBatch::start(int i, std::uint64_t episode, const EpisodeDraw& draw) {
  stop(i);
  EpisodeState& state = states_[i];
  const int first = i * plan_.num_sensors;
  ++num_busy_;
  busy_[i] = 1;
  episodes_[i] = episode;
  objects_[i] = draw.object;
  state.draw = draw;
  flags_[i] = 0;
  if (variesMounting(plan_.scene.randomization)) {
    flags_[i] |= kMounted;
    state.X_NS = poseOf(draw.mounting);
  }
  if (draw.linear_action_noise != 0 || draw.angular_action_noise != 0) flags_[i] |= kActionNoise;
  if (draw.load_driven && plan_.num_sensors > 1) flags_[i] |= kWarmsUp;
  frame_numbers_[i] = has(i, kWarmsUp) ? -1 : 0;
  state.trajectory.reset();
  if (draw.load_driven) loads_[first] = draw.load;
  for (int s = first; s < first + plan_.num_sensors; ++s) ids_[s] = draw.object;
  X_WO_[i] = draw.X_SO;
  updatePoses(i);
  X_SO_[first] = inSensor(i, X_WO_[i]);  // sensor 0 starts at the origin of W; avoids the rounding of its forward kinematics
  times_[i] = 0;
  resetSensors(i);
}

Pose EpisodeBatch::inSensor(int i, const Pose& X_NO) const {
  return has(i, kMounted) ? inlined::relative(states_[i].X_NS, X_NO) : X_NO;
}

void EpisodeBatch::prepare() {
  simulator_.prepare(plan_.scene.randomization.load.has_value());
}

// Every sensor has its own key of random numbers, hence independent noise.
void EpisodeBatch::resetSensors(int i) {
  const auto num_sensors = static_cast<std::uint64_t>(plan_.num_sensors);
  for (std::uint64_t s = 0; s < num_sensors; ++s) {
    simulator_.reset(i * plan_.num_sensors + static_cast<int>(s), episodes_[i] * num_sensors + s, states_[i].draw.variation,
                     states_[i].draw.skin);
  }
}

// The points of the next frame of each instance.
void EpisodeBatch::setContacts(const ContactRecording& recording) {
  contacts_.clear();
  offsets_.assign(1, 0);
  for (int i = 0; i < numInstances(); ++i) {
    if (busy_[i]) {
      const std::span<const ContactPoint> points = recording.pointsOf(episodes_[i], frame_numbers_[i]);
      contacts_.insert(contacts_.end(), points.begin(), points.end());
    }
    offsets_.push_back(static_cast<int>(contacts_.size()));
  }
  simulator_.setContacts(contacts_, offsets_);
}

void EpisodeBatch::setChangedInputs() {
  for (int i = 0; i < numInstances(); ++i) {
    const int changes = std::exchange(changes_[i], 0);
    if (changes & kObjectChanged) simulator_.setObjects(i, std::span(&ids_[i], 1), std::span(&X_SO_[i], 1));
    if (changes & kLoadChanged) simulator_.setLoad(i, loads_[i]);
  }
}

void EpisodeBatch::read() {
  frame_ = simulator_.read();
  if (loop_) loop_->read();
}

void EpisodeBatch::setInputs() {
  if (loop_) return setChangedInputs();
  if (plan_.scene.contact_points) return setContacts(*plan_.scene.contact_points);
  simulator_.setObjects(ids_, X_SO_);
  if (loads_changed_) simulator_.setLoads(loads_);
  loads_changed_ = false;
}

// After the first frame: fixes the object's pose where the load search left it, and starts its trajectory there.
void EpisodeBatch::initialContact(int i) {
  EpisodeState& state = states_[i];
  const EpisodeDraw& draw = state.draw;
  const int first = i * plan_.num_sensors;
  state.load_offset = draw.load_driven ? frame_.ground_truth.load_offset[first] : 0.0;
  load_reached_[i] = !draw.load_driven || frame_.ground_truth.load_reached[first] != 0;
  const Vector3 moved_S{0, 0, state.load_offset}, moved_N = has(i, kMounted) ? rotate(state.X_NS.rotation, moved_S) : moved_S;
  X_WO_[i].position = add(X_WO_[i].position, moved_N);
  X_SO_[first] = inSensor(i, X_WO_[i]);
  if (draw.load_driven) {
    loads_[first] = kPoseDriven;
    changes_[i] |= kLoadChanged;
    loads_changed_ = true;
  }
  if (draw.object == kNoObject) return;
  const std::optional<Motion>& motion = plan_.scene.objects[static_cast<std::size_t>(draw.object)].motion;
  if (!motion) return;
  flags_[i] |= kMoves;
  state.trajectory.emplace(*motion, X_WO_[i], MotionKey{.seed = plan_.scene.seed, .episode = episodes_[i]});
}

void EpisodeBatch::beginFrame(int i) {
  if (frame_numbers_[i] == (has(i, kWarmsUp) ? -1 : 0)) initialContact(i);
  active_[i] = frame_numbers_[i] >= 0;
  if (!active_[i]) return;
  if (frame_numbers_[i] == 0) start_forces_[i] = plan_.starts_at_load ? states_[i].draw.load : frame_.total_force[i * plan_.num_sensors];
  control_due_[i] = frame_numbers_[i] % plan_.control_period == 0;
}

void EpisodeBatch::beginFrame() {
  for (int i = 0; i < numInstances(); ++i) {
    if (busy_[i]) beginFrame(i);
  }
}

// One frame of some instances.
void EpisodeBatch::computeFrames(std::span<const std::uint8_t> instances) {
  for (int i = 0; i < numInstances(); ++i) {
    for (int s = i * plan_.num_sensors; s < (i + 1) * plan_.num_sensors; ++s) {
      computed_[s] = instances[i] != 0;
      if (!computed_[s]) continue;
      simulator_.setObjects(s, std::span(&ids_[s], 1), std::span(&X_SO_[s], 1));
      simulator_.setLoad(s, loads_[s]);
    }
  }
  simulator_.step(plan_.dt, computed_);
  read();
  for (int i = 0; i < numInstances(); ++i) {
    if (instances[i]) beginFrame(i);
  }
}

void EpisodeBatch::computeFirstFrames(std::span<const std::uint8_t> instances) {
  computeFrames(instances);
  bool had_warm_up = false;
  for (int i = 0; i < numInstances(); ++i) {
    if (!instances[i] || active_[i]) continue;
    had_warm_up = true;
    nextFrame(i);
  }
  // The start is load-driven for all episodes of a scene or for none, and so is the warm-up frame.
  if (had_warm_up) computeFrames(instances);
}

EpisodeRecord EpisodeBatch::record(int i) const {
  const EpisodeDraw& draw = states_[i].draw;
  return {.episode = episodes_[i],
          .object = draw.object,
          .load = draw.load,
          .load_driven = draw.load_driven,
          .depth = static_cast<float>(draw.depth - states_[i].load_offset),
          .load_reached = load_reached_[i],
          .gain = draw.variation.gain,
          .gain_spread = draw.variation.gain_spread,
          .noise = draw.variation.noise,
          .linear_action_noise = static_cast<float>(draw.linear_action_noise),
          .angular_action_noise = static_cast<float>(draw.angular_action_noise),
          .skin = draw.skin,
          .mounting = draw.mounting,
          .start_force = start_forces_[i]};
}

FrameContext EpisodeBatch::context() const {
  return {.active = active_,
          .times = times_,
          .num_sensors = plan_.num_sensors,
          .X_SO = loop_ ? loop_->X_SO() : X_SO_,
          .X_WO = X_WO_,
          .actions = loop_ ? loop_->actions() : actions_,
          .controller_actions = loop_ ? loop_->actions() : twists_,
          .X_WS = loop_ ? loop_->X_WS() : robots_.X_WS(),
          .joint_positions = loop_ ? loop_->jointPositions() : robots_.jointPositions(),
          .joint_velocities = loop_ ? loop_->jointVelocities() : robots_.jointVelocities(),
          .robot_status = loop_ ? loop_->status() : robots_.status(),
          .team = &team_};
}

// Poses of the object in the sensors at the current frame, after the robot has moved.
void EpisodeBatch::updatePoses(int i) {
  if (has(i, kMoves)) X_WO_[i] = states_[i].trajectory->at(frame_numbers_[i] * plan_.dt);
  const std::span<const Pose> X_WS = robots_.X_WS();
  for (int s = i * plan_.num_sensors; s < (i + 1) * plan_.num_sensors; ++s) X_SO_[s] = inSensor(i, inlined::relative(X_WS[s], X_WO_[i]));
}

// Noise of one component of an action. Counter-based: a function of (seed, episode, frame, component) alone.
double EpisodeBatch::actionNoise(int i, std::uint32_t component, double deviation) const {
  return deviation * gaussian({.seed = plan_.scene.seed,
                               .episode = episodes_[i],
                               .frame = static_cast<std::uint32_t>(frame_numbers_[i]),
                               .taxel = component,
                               .purpose = Purpose::kActionNoise});
}

void EpisodeBatch::act(std::span<const Twist> twists, int first, int last) {
  for (int i = first; i < last; ++i) {
    if (!control_due_[i]) continue;
    by_joints_[i] = 0;
    twists_[i] = actions_[i] = twists[i];
    if (!has(i, kActionNoise)) continue;
    const EpisodeDraw& draw = states_[i].draw;
    for (std::uint32_t k = 0; k < 3; ++k) {
      actions_[i].v[k] += actionNoise(i, k, draw.linear_action_noise);
      actions_[i].w[k] += actionNoise(i, k + 3, draw.angular_action_noise);
    }
  }
}

void EpisodeBatch::actJoints(std::span<const double> velocities) {
  const std::vector<Joint>& joints = std::get<Manipulator>(plan_.scene.robot).joints;
  for (int i = 0; i < numInstances(); ++i) {
    if (!control_due_[i]) continue;
    by_joints_[i] = 1;
    const std::size_t first = static_cast<std::size_t>(i) * joints.size();
    const std::span<double> actions = std::span(joint_actions_).subspan(first, joints.size());
    std::copy_n(velocities.begin() + static_cast<std::ptrdiff_t>(first), joints.size(), actions.begin());
    twists_[i] = actions_[i] = robots_.twistOf(i, actions);
    if (!has(i, kActionNoise)) continue;
    const EpisodeDraw& draw = states_[i].draw;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const bool is_revolute = joints[j].type == JointType::kRevolute;
      actions[j] += actionNoise(i, static_cast<std::uint32_t>(j), is_revolute ? draw.angular_action_noise : draw.linear_action_noise);
    }
    actions_[i] = robots_.twistOf(i, actions);
  }
}

void EpisodeBatch::checkActions(std::span<const Twist> twists, int first_instance) const {
  static constexpr std::array kNames{"v_x", "v_y", "v_z", "w_x", "w_y", "w_z"};
  for (int i = 0; i < numInstances(); ++i) {
    if (!control_due_[i]) continue;
    for (std::size_t k = 0; k < kNames.size(); ++k) {
      const double value = k < 3 ? twists[i].v[k] : twists[i].w[k - 3];
      if (!std::isfinite(value)) refuseAction(first_instance + i, episodes_[i], kNames[k], value);
    }
  }
}

void EpisodeBatch::checkJointActions(std::span<const double> velocities, int first_instance) const {
  const std::vector<Joint>& joints = std::get<Manipulator>(plan_.scene.robot).joints;
  for (int i = 0; i < numInstances(); ++i) {
    if (!control_due_[i]) continue;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const double value = velocities[static_cast<std::size_t>(i) * joints.size() + j];
      if (!std::isfinite(value)) refuseAction(first_instance + i, episodes_[i], "velocity of joint " + joints[j].name, value);
    }
  }
}

void EpisodeBatch::nextFrame(int i) {
  if (++frame_numbers_[i] == plan_.num_frames) {
    ended_[i] = 1;
    stop(i);
    return;
  }
  if (frame_numbers_[i] == 0) {
    robots_.reset(i, Pose{});
    resetSensors(i);
  }
  continueEpisode(i);
}

void EpisodeBatch::continueEpisode(int i) {
  if (!loop_) updatePoses(i);
  times_[i] = frame_numbers_[i] * plan_.dt;
}

void EpisodeBatch::advance() {
  moveRobots();
  moveObjects();
}

void EpisodeBatch::moveRobots() {
  if (loop_) return;
  robots_.command(actions_, joint_actions_, by_joints_, plan_.dt, team_);
}

void EpisodeBatch::moveObjects() {
  constexpr std::uint8_t kLater = 2;
  team_.run(numInstances(), [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      ended_[i] = 0;
      if (!busy_[i]) continue;
      if (const int next = frame_numbers_[i] + 1; next == 0 || next == plan_.num_frames) {
        ended_[i] = kLater;
      } else {
        frame_numbers_[i] = next;
        continueEpisode(i);
      }
    }
  });
  // Starts and ends of episodes change the whole batch.
  for (int i = 0; i < numInstances(); ++i) {
    if (ended_[i] != kLater) continue;
    ended_[i] = 0;
    nextFrame(i);
  }
}

}  // namespace taxelsim
