#include "episodes/slice.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "base/philox.h"
#include "base/vector3.h"

namespace taxelsim {
namespace {

// Seconds since it was made or last asked.
class Stopwatch {
 public:
  double lap() {
    const Clock::time_point now = Clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

}  // namespace

EpisodePlan::EpisodePlan(const Scene& of_scene, const OutputOptions& of_sinks, std::optional<int> of_all)
    : scene(of_scene),
      drawer(of_scene),
      outputs(of_sinks),
      num_sensors(numSensors(of_scene)),
      num_frames(numFrames(of_scene)),
      dt(1 / of_scene.simulation_rate),
      control_period(std::max(1, static_cast<int>(std::lround(of_scene.simulation_rate / of_scene.control_rate)))),
      controller(of_all) {
  for (const SceneObject& object : scene.objects) edges.emplace_back(object);
  if (scene.kind != Scene::Kind::kServo) return;
  for (int c = 0; c < static_cast<int>(scene.controllers.size()); ++c) {
    if (controller && *controller != c) continue;
    const TactileServo& servo = scene.controllers[static_cast<std::size_t>(c)].servo;
    wants_contact = wants_contact || needsContactFeatures(servo);
    wants_jacobian = wants_jacobian || needsTactileJacobian(servo);
    wants_exact_angle = wants_exact_angle || servo.edge_angle_source == EdgeAngleSource::kExact;
  }
  outputs.contact_features = outputs.contact_features || wants_contact;
  outputs.tactile_jacobian = outputs.tactile_jacobian || wants_jacobian;
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
      slots_(num_instances),
      busy_(num_instances, 0),
      shown_(num_instances, 0),
      X_WO_(num_instances),
      times_(num_instances, 0.0),
      twists_(num_instances),
      actions_(num_instances),
      exact_angles_(plan.wants_exact_angle ? num_instances : 0),
      start_forces_(num_instances, 0.0f),
      due_(num_instances, 0) {
  if (plan.scene.kind == Scene::Kind::kServo) {
    std::vector<TactileServo> servos;
    for (const SceneController& controller : plan.scene.controllers) servos.push_back(controller.servo);
    controller_.emplace(servos, plan.scene.sensor, num_instances);
  }
  for (int i = 0; i < num_instances; ++i) startEpisode(i);
  simulator_.prepare(plan.scene.randomisation.load.has_value());
}

void Slice::startEpisode(int i) {
  Slot& slot = slots_[i];
  const int first = i * plan_.num_sensors;
  const std::optional<std::uint64_t> episode = sink_.next(i);
  num_busy_ += static_cast<int>(episode.has_value()) - static_cast<int>(busy_[i]);
  busy_[i] = episode.has_value();
  shown_[i] = due_[i] = 0;
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
  slot.episode = *episode;
  slot.draw = plan_.drawer.draw(*episode);
  slot.frame = slot.first_frame = slot.draw.load_driven && plan_.num_sensors > 1 ? -1 : 0;
  slot.trajectory.reset();
  if (slot.draw.load_driven) loads_[first] = slot.draw.load;
  for (int s = first; s < first + plan_.num_sensors; ++s) ids_[s] = slot.draw.object;
  X_WO_[i] = slot.draw.X_SO;
  follow(i);
  X_SO_[first] = X_WO_[i];  // where the base was placed so that the first sensor is, but for rounding
  times_[i] = 0;
  resetSensors(i);
  slot.controller = plan_.controller.value_or(slot.draw.controller);
  if (controller_) controller_->reset(i, slot.controller, slot.draw.exploration_velocity);
}

// Every sensor has noise of its own.
void Slice::resetSensors(int i) {
  const auto num_sensors = static_cast<std::uint64_t>(plan_.num_sensors);
  for (std::uint64_t s = 0; s < num_sensors; ++s) {
    simulator_.reset(i * plan_.num_sensors + static_cast<int>(s), slots_[i].episode * num_sensors + s, slots_[i].draw.variation);
  }
}

void Slice::submit() {
  Stopwatch stopwatch;
  simulator_.setObjects(ids_, X_SO_);
  if (std::exchange(loads_changed_, false)) simulator_.setLoads(loads_);
  submit_seconds_ = stopwatch.lap();
  simulator_.step(plan_.dt);
}

// The first sensor has felt the object: it stays where its load has put it.
void Slice::settle(int i, const FrameView& frame) {
  Slot& slot = slots_[i];
  const EpisodeDraw& draw = slot.draw;
  const int first = i * plan_.num_sensors;
  slot.load_offset = draw.load_driven ? frame.ground_truth.load_offset[first] : 0.0;
  slot.load_reached = !draw.load_driven || frame.ground_truth.load_reached[first] != 0;
  X_WO_[i].position[2] += slot.load_offset;
  X_SO_[first] = X_WO_[i];
  if (draw.load_driven) {
    loads_[first] = kPoseDriven;
    loads_changed_ = true;
  }
  const std::optional<Motion>& motion = plan_.scene.objects[static_cast<std::size_t>(draw.object)].motion;
  if (motion) slot.trajectory.emplace(*motion, X_WO_[i], MotionKey{.seed = plan_.scene.seed, .episode = slot.episode});
}

// The first frame that is seen.
void Slice::announce(int i, const FrameView& frame) {
  const Slot& slot = slots_[i];
  const EpisodeDraw& draw = slot.draw;
  // Without a load to hold, the servo holds the force that it met.
  start_forces_[i] = draw.load_driven ? draw.load : frame.total_force[i * plan_.num_sensors];
  sink_.begin(i, {.episode = slot.episode,
                  .object = draw.object,
                  .load = draw.load,
                  .load_driven = draw.load_driven,
                  .depth = static_cast<float>(draw.depth - slot.load_offset),
                  .load_reached = slot.load_reached,
                  .gain = draw.variation.gain,
                  .gain_spread = draw.variation.gain_spread,
                  .noise = draw.variation.noise,
                  .controller = slot.controller,
                  .exploration_velocity = controller_ ? static_cast<float>(controller_->explorationVelocity(i)) : 0.0f,
                  .linear_action_noise = static_cast<float>(draw.linear_action_noise),
                  .angular_action_noise = static_cast<float>(draw.angular_action_noise),
                  .start_force = start_forces_[i]});
}

// The robot has gone on to the slot's frame; so does the object.
void Slice::follow(int i) {
  Slot& slot = slots_[i];
  if (slot.trajectory) X_WO_[i] = slot.trajectory->at(slot.frame * plan_.dt);
  for (int s = i * plan_.num_sensors; s < (i + 1) * plan_.num_sensors; ++s) X_SO_[s] = inverse(robots_.X_WS()[s]) * X_WO_[i];
}

// New in every tick, whatever came before.
Twist Slice::actionNoise(int i) const {
  const Slot& slot = slots_[i];
  Twist noise;
  DrawKey key{.seed = plan_.scene.seed,
              .episode = slot.episode,
              .frame = static_cast<std::uint32_t>(slot.frame),
              .taxel = 0,
              .purpose = Purpose::kActionNoise};
  for (double& component : noise.v) component = slot.draw.linear_action_noise * gaussian(key), ++key.taxel;
  for (double& component : noise.w) component = slot.draw.angular_action_noise * gaussian(key), ++key.taxel;
  return noise;
}

// Looks at the frame; between its ticks an instance goes on as it does.
void Slice::control(const FrameView& frame) {
  if (plan_.wants_exact_angle) {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      if (due_[i]) {
        exact_angles_[i] =
            static_cast<float>(plan_.edges[static_cast<std::size_t>(slots_[i].draw.object)].project(X_SO_[i * plan_.num_sensors]).angle);
      }
    }
  }
  const FeatureView& features = plan_.wants_contact ? static_cast<const FeatureView&>(frame.contact) : frame;
  controller_->command({.num_rows = plan_.num_sensors * (plan_.wants_contact ? frame.contact.num_rows : 1),
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
                        .exact_edge_angle = exact_angles_,
                        .start_force = start_forces_,
                        .due = due_},
                       plan_.control_period * plan_.dt, twists_);
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (!due_[i]) continue;
    actions_[i] = twists_[i];
    const EpisodeDraw& draw = slots_[i].draw;
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
  Stats tally{.control_seconds = submit_seconds_, .wait_seconds = stopwatch.lap(), .device_seconds = simulator_.timing().total};

  for (int i = 0; i < num_instances; ++i) {
    if (!busy_[i]) continue;
    Slot& slot = slots_[i];
    if (slot.frame == slot.first_frame) settle(i, frame);
    shown_[i] = slot.frame >= 0;
    if (!shown_[i]) continue;
    ++tally.num_frames;
    if (slot.frame == 0) {
      announce(i, frame);
      if (!slot.load_reached) ++tally.num_load_misses;
    }
    due_[i] = slot.frame % plan_.control_period == 0;
  }
  if (controller_) control(frame);
  tally.control_seconds += stopwatch.lap();
  sink_.frame(frame, {.active = shown_,
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
    Slot& slot = slots_[i];
    ++slot.frame;
    if (slot.frame == plan_.num_frames) {
      ++tally.num_episodes;
      sink_.end(i);
      startEpisode(i);
      continue;
    }
    if (slot.frame == 0) {
      robots_.reset(i, Pose{});
      resetSensors(i);
    }
    follow(i);
    times_[i] = slot.frame * plan_.dt;
  }
  tally.control_seconds += stopwatch.lap();
  return tally;
}

}  // namespace taxelsim
