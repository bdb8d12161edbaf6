#include "episodes/slice.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "base/philox.h"
#include "base/vector3.h"

namespace taxelsim {
namespace {

class Stopwatch {
 public:
  // Seconds since construction or the preceding lap().
  double lap() {
    const SteadyClock::time_point now = SteadyClock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  using SteadyClock = std::chrono::steady_clock;
  SteadyClock::time_point last_ = SteadyClock::now();
};

}  // namespace

EpisodePlan::EpisodePlan(const Scene& scene_to_run, const OutputOptions& sink_outputs, std::optional<int> fixed_controller)
    : scene(scene_to_run),
      drawer(scene_to_run),
      outputs(sink_outputs),
      num_sensors(numSensors(scene_to_run)),
      num_frames(numFrames(scene_to_run)),
      dt(1 / scene_to_run.simulation_rate),
      control_period(std::max(1, static_cast<int>(std::lround(scene_to_run.simulation_rate / scene_to_run.control_rate)))),
      controller(fixed_controller) {
  for (const SceneObject& object : scene.objects) edges.emplace_back(object);
  if (scene.kind != Scene::Kind::kServo) return;
  for (int c = 0; c < static_cast<int>(scene.controllers.size()); ++c) {
    if (controller && *controller != c) continue;
    const TactileServo& servo = scene.controllers[static_cast<std::size_t>(c)].servo;
    needs_contact_features = needs_contact_features || needsContactFeatures(servo);
    needs_jacobian = needs_jacobian || needsTactileJacobian(servo);
    needs_true_angle = needs_true_angle || servo.edge_angle_source == EdgeAngleSource::kExact;
  }
  outputs.contact_features = outputs.contact_features || needs_contact_features;
  outputs.tactile_jacobian = outputs.tactile_jacobian || needs_jacobian;
}

SimulatorOptions EpisodePlan::simulatorOptions(int num_instances) const {
  return {.num_instances = num_instances * num_sensors,
          .num_slots = 1,
          .seed = scene.seed,
          .outputs = outputs,
          .max_regions = outputs.contact_features || outputs.clean_contact_features ? numRegions(scene) : 0,
          .device_clock = device_clock};
}

Slice::Slice(const Model& model, const EpisodePlan& plan, int num_instances, EpisodeSink& sink)
    : plan_(plan),
      sink_(sink),
      simulator_(model, plan.simulatorOptions(num_instances)),
      robots_(plan.scene.robot, num_instances),
      ids_(num_instances * plan.num_sensors, kNoObject),
      X_SO_(num_instances * plan.num_sensors),
      loads_(num_instances * plan.num_sensors, kPoseDriven),
      episodes_(num_instances),
      busy_(num_instances, 0),
      recorded_(num_instances, 0),
      X_WO_(num_instances),
      times_(num_instances, 0.0),
      twists_(num_instances),
      actions_(num_instances),
      true_angles_(plan.needs_true_angle ? num_instances : 0),
      start_forces_(num_instances, 0.0f),
      control_due_(num_instances, 0) {
  if (plan.scene.kind == Scene::Kind::kServo) {
    std::vector<TactileServo> servos;
    for (const SceneController& controller : plan.scene.controllers) servos.push_back(controller.servo);
    controller_.emplace(servos, plan.scene.sensor, num_instances);
  }
  for (int i = 0; i < num_instances; ++i) startEpisode(i);
  simulator_.prepare(plan.scene.randomization.load.has_value());
}

void Slice::startEpisode(int i) {
  EpisodeState& state = episodes_[i];
  const int first = i * plan_.num_sensors;
  const std::optional<std::uint64_t> episode = sink_.next(i);
  num_busy_ += static_cast<int>(episode.has_value()) - static_cast<int>(busy_[i]);
  busy_[i] = episode.has_value();
  recorded_[i] = control_due_[i] = 0;
  robots_.reset(i, Pose{});
  loads_changed_ = true;
  loads_[first] = kPoseDriven;
  twists_[i] = actions_[i] = {};
  if (!episode) {
    for (int s = first; s < first + plan_.num_sensors; ++s) {
      ids_[s] = kNoObject;
      X_SO_[s] = Pose{};
    }
    return;
  }
  state.episode = *episode;
  state.draw = plan_.drawer.draw(*episode);
  state.frame = state.first_frame = state.draw.load_driven && plan_.num_sensors > 1 ? -1 : 0;
  state.trajectory.reset();
  if (state.draw.load_driven) loads_[first] = state.draw.load;
  for (int s = first; s < first + plan_.num_sensors; ++s) ids_[s] = state.draw.object;
  X_WO_[i] = state.draw.X_SO;
  updatePoses(i);
  X_SO_[first] = X_WO_[i];  // sensor 0 starts at the origin of W; avoids the rounding of its forward kinematics
  times_[i] = 0;
  resetSensors(i);
  state.controller = plan_.controller.value_or(state.draw.controller);
  if (controller_) controller_->reset(i, state.controller, state.draw.exploration_velocity);
}

// Every sensor has its own key of random numbers, hence independent noise.
void Slice::resetSensors(int i) {
  const auto num_sensors = static_cast<std::uint64_t>(plan_.num_sensors);
  for (std::uint64_t s = 0; s < num_sensors; ++s) {
    simulator_.reset(i * plan_.num_sensors + static_cast<int>(s), episodes_[i].episode * num_sensors + s, episodes_[i].draw.variation);
  }
}

void Slice::submit() {
  Stopwatch stopwatch;
  simulator_.setObjects(ids_, X_SO_);
  if (std::exchange(loads_changed_, false)) simulator_.setLoads(loads_);
  submit_seconds_ = stopwatch.lap();
  simulator_.step(plan_.dt);
}

// After the first frame: fixes the object's pose where the load search left it, and starts its trajectory there.
void Slice::initialContact(int i, const FrameView& frame) {
  EpisodeState& state = episodes_[i];
  const EpisodeDraw& draw = state.draw;
  const int first = i * plan_.num_sensors;
  state.load_offset = draw.load_driven ? frame.ground_truth.load_offset[first] : 0.0;
  state.load_reached = !draw.load_driven || frame.ground_truth.load_reached[first] != 0;
  X_WO_[i].position[2] += state.load_offset;
  X_SO_[first] = X_WO_[i];
  if (draw.load_driven) {
    loads_[first] = kPoseDriven;
    loads_changed_ = true;
  }
  const std::optional<Motion>& motion = plan_.scene.objects[static_cast<std::size_t>(draw.object)].motion;
  if (motion) state.trajectory.emplace(*motion, X_WO_[i], MotionKey{.seed = plan_.scene.seed, .episode = state.episode});
}

// Passes the constants of the episode to the sink.
void Slice::beginRecord(int i, const FrameView& frame) {
  const EpisodeState& state = episodes_[i];
  const EpisodeDraw& draw = state.draw;
  // A depth-driven episode holds the force of its first frame.
  start_forces_[i] = draw.load_driven ? draw.load : frame.total_force[i * plan_.num_sensors];
  sink_.begin(i, {.episode = state.episode,
                  .object = draw.object,
                  .load = draw.load,
                  .load_driven = draw.load_driven,
                  .depth = static_cast<float>(draw.depth - state.load_offset),
                  .load_reached = state.load_reached,
                  .gain = draw.variation.gain,
                  .gain_spread = draw.variation.gain_spread,
                  .noise = draw.variation.noise,
                  .controller = state.controller,
                  .exploration_velocity = controller_ ? static_cast<float>(controller_->explorationVelocity(i)) : 0.0f,
                  .linear_action_noise = static_cast<float>(draw.linear_action_noise),
                  .angular_action_noise = static_cast<float>(draw.angular_action_noise),
                  .start_force = start_forces_[i]});
}

// Poses of the object in the sensors at the current frame, after the robot has moved.
void Slice::updatePoses(int i) {
  EpisodeState& state = episodes_[i];
  if (state.trajectory) X_WO_[i] = state.trajectory->at(state.frame * plan_.dt);
  for (int s = i * plan_.num_sensors; s < (i + 1) * plan_.num_sensors; ++s) X_SO_[s] = inverse(robots_.X_WS()[s]) * X_WO_[i];
}

// Counter-based: a function of (seed, episode, frame) alone.
Twist Slice::actionNoise(int i) const {
  const EpisodeState& state = episodes_[i];
  Twist noise;
  DrawKey key{.seed = plan_.scene.seed,
              .episode = state.episode,
              .frame = static_cast<std::uint32_t>(state.frame),
              .taxel = 0,
              .purpose = Purpose::kActionNoise};
  for (double& component : noise.v) component = state.draw.linear_action_noise * gaussian(key), ++key.taxel;
  for (double& component : noise.w) component = state.draw.angular_action_noise * gaussian(key), ++key.taxel;
  return noise;
}

// Updates the twists of instances whose control tick is due; the others keep theirs.
void Slice::control(const FrameView& frame) {
  if (plan_.needs_true_angle) {
    for (std::size_t i = 0; i < episodes_.size(); ++i) {
      if (control_due_[i]) {
        true_angles_[i] =
            static_cast<float>(plan_.edges[static_cast<std::size_t>(episodes_[i].draw.object)].project(X_SO_[i * plan_.num_sensors]).angle);
      }
    }
  }
  const FeatureView& features = plan_.needs_contact_features ? static_cast<const FeatureView&>(frame.contact) : frame;
  controller_->command({.num_rows = plan_.num_sensors * (plan_.needs_contact_features ? frame.contact.num_rows : 1),
                        .region_row = 1 + frame.contact.num_patches,
                        .edge_angle = features.edge_angle,
                        .edge_confidence = features.edge_confidence,
                        .total_force = features.total_force,
                        .center_of_pressure = features.center_of_pressure,
                        .contact_area = features.contact_area,
                        .windowed_edge_angle = frame.contact.windowed_edge_angle,
                        .windowed_edge_confidence = frame.contact.windowed_edge_confidence,
                        .tilt = frame.contact.tilt,
                        .tilt_confidence = frame.contact.tilt_confidence,
                        .num_jacobian_rows = plan_.num_sensors * frame.jacobian.num_rows,
                        .center_jacobian = frame.jacobian.center_of_pressure,
                        .force_jacobian = frame.jacobian.total_force,
                        .edge_angle_jacobian = frame.jacobian.edge_angle,
                        .exact_edge_angle = true_angles_,
                        .start_force = start_forces_,
                        .due = control_due_},
                       plan_.control_period * plan_.dt, twists_);
  for (std::size_t i = 0; i < episodes_.size(); ++i) {
    if (!control_due_[i]) continue;
    actions_[i] = twists_[i];
    const EpisodeDraw& draw = episodes_[i].draw;
    if (draw.linear_action_noise == 0 && draw.angular_action_noise == 0) continue;
    const Twist noise = actionNoise(static_cast<int>(i));
    actions_[i].v = add(actions_[i].v, noise.v);
    actions_[i].w = add(actions_[i].w, noise.w);
  }
}

Slice::Stats Slice::collect() {
  Stopwatch stopwatch;
  const FrameView frame = simulator_.read();
  const int num_instances = robots_.numInstances();
  Stats stats{.control_seconds = submit_seconds_, .wait_seconds = stopwatch.lap(), .device_seconds = simulator_.timing().total};

  for (int i = 0; i < num_instances; ++i) {
    if (!busy_[i]) continue;
    EpisodeState& state = episodes_[i];
    if (state.frame == state.first_frame) initialContact(i, frame);
    recorded_[i] = state.frame >= 0;
    if (!recorded_[i]) continue;
    ++stats.num_frames;
    if (state.frame == 0) {
      beginRecord(i, frame);
      if (!state.load_reached) ++stats.num_load_misses;
    }
    control_due_[i] = state.frame % plan_.control_period == 0;
  }
  if (controller_) control(frame);
  stats.control_seconds += stopwatch.lap();
  sink_.frame(frame, {.active = recorded_,
                      .times = times_,
                      .num_sensors = plan_.num_sensors,
                      .X_SO = X_SO_,
                      .X_WO = X_WO_,
                      .actions = actions_,
                      .controller_actions = twists_,
                      .robots = &robots_});
  stopwatch.lap();
  robots_.command(actions_, plan_.dt);

  for (int i = 0; i < num_instances; ++i) {
    if (!busy_[i]) continue;
    EpisodeState& state = episodes_[i];
    ++state.frame;
    if (state.frame == plan_.num_frames) {
      ++stats.num_episodes;
      sink_.end(i);
      startEpisode(i);
      continue;
    }
    if (state.frame == 0) {
      robots_.reset(i, Pose{});
      resetSensors(i);
    }
    updatePoses(i);
    times_[i] = state.frame * plan_.dt;
  }
  stats.control_seconds += stopwatch.lap();
  return stats;
}

}  // namespace taxelsim
