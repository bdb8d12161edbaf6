#include "episodes/slice.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace taxelsim {

EpisodePlan::EpisodePlan(const Scene& of_scene)
    : scene(of_scene),
      drawer(of_scene),
      columns(planColumns(of_scene)),
      recorder(columns),
      num_frames(numFrames(of_scene)),
      dt(1 / of_scene.simulation_rate),
      control_period(std::max(1, static_cast<int>(std::lround(of_scene.simulation_rate / of_scene.control_rate)))) {}

Slice::Slice(const Model& model, const EpisodePlan& plan, int num_instances)
    : plan_(plan),
      simulator_(model, {.num_instances = num_instances,
                         .num_slots = 1,
                         .seed = plan.scene.seed,
                         .outputs = plan.columns.outputs,
                         .max_regions = plan.columns.max_regions}),
      robots_(plan.scene.robot, num_instances),
      slots_(num_instances),
      ids_(num_instances, kNoObject),
      X_SO_(num_instances),
      loads_(num_instances, kPoseDriven),
      places_(num_instances),
      times_(num_instances, 0.0),
      twists_(num_instances),
      start_forces_(num_instances, 0.0f),
      due_(num_instances, 0) {
  if (plan.scene.kind == Scene::Kind::kServo) controller_.emplace(plan.scene.controller, plan.scene.sensor, num_instances);
}

void Slice::begin(ShardQueue& queue) {
  for (int i = 0; i < simulator_.numInstances(); ++i) startEpisode(i, queue);
}

void Slice::startEpisode(int i, ShardQueue& queue) {
  Slot& slot = slots_[i];
  const bool was_busy = places_[i].columns != nullptr;
  const std::optional<EpisodePlace> place = queue.next();
  num_busy_ += static_cast<int>(place.has_value()) - static_cast<int>(was_busy);
  robots_.reset(i, Pose{});
  loads_changed_ = true;
  if (!place) {
    ids_[i] = kNoObject;
    X_SO_[i] = Pose{};
    loads_[i] = kPoseDriven;
    places_[i] = {};
    due_[i] = 0;
    twists_[i] = {};
    return;
  }
  slot.place = *place;
  slot.frame = 0;
  slot.draw = plan_.drawer.draw(place->episode);
  ids_[i] = slot.draw.object;
  X_SO_[i] = slot.draw.X_SO;
  loads_[i] = slot.draw.load_driven ? slot.draw.load : kPoseDriven;
  places_[i] = {place->buffer->columns.data(), place->row * static_cast<std::uint64_t>(plan_.num_frames)};
  times_[i] = 0;
  simulator_.reset(i, place->episode, slot.draw.variation);
  if (controller_) controller_->reset(i);
}

void Slice::submit() {
  simulator_.setObjects(ids_, X_SO_);
  if (std::exchange(loads_changed_, false)) simulator_.setLoads(loads_);
  simulator_.step(plan_.dt);
}

// After the first frame: the object stays where its load has put it. Returns whether the load was reached.
bool Slice::settle(int i, const FrameView& frame) {
  Slot& slot = slots_[i];
  const EpisodeDraw& draw = slot.draw;
  const double load_offset = draw.load_driven ? frame.ground_truth.load_offset[i] : 0.0;
  const bool load_reached = !draw.load_driven || frame.ground_truth.load_reached[i] != 0;
  X_SO_[i].position[2] += load_offset;
  slot.X_WO = X_SO_[i];
  const std::optional<Motion>& motion = plan_.scene.objects[static_cast<std::size_t>(draw.object)].motion;
  slot.trajectory.reset();
  if (motion) slot.trajectory.emplace(*motion, slot.X_WO, MotionKey{.seed = plan_.scene.seed, .episode = slot.place.episode});
  if (draw.load_driven) {
    loads_[i] = kPoseDriven;
    loads_changed_ = true;
  }
  // Without a load to hold, the servo holds the force that it met.
  start_forces_[i] = draw.load_driven ? draw.load : frame.total_force[i];
  plan_.recorder.recordEpisode({.episode = slot.place.episode,
                                .object = draw.object,
                                .load = draw.load,
                                .load_driven = draw.load_driven,
                                .depth = static_cast<float>(draw.depth - load_offset),
                                .load_reached = load_reached,
                                .gain = draw.variation.gain,
                                .gain_spread = draw.variation.gain_spread,
                                .noise = draw.variation.noise},
                               slot.place);
  return load_reached;
}

// The robot has gone on to the slot's frame; so does the object.
void Slice::follow(int i) {
  Slot& slot = slots_[i];
  if (slot.trajectory) slot.X_WO = slot.trajectory->at(slot.frame * plan_.dt);
  X_SO_[i] = inverse(robots_.X_WS()[i]) * slot.X_WO;
}

Slice::Tally Slice::collect(ShardQueue& queue, ShardWriter& writer) {
  const FrameView frame = simulator_.read();
  const int num_instances = simulator_.numInstances();
  Tally tally;

  for (int i = 0; i < num_instances; ++i) {
    if (!places_[i].columns) continue;
    ++tally.num_frames;
    if (slots_[i].frame == 0 && !settle(i, frame)) ++tally.num_load_misses;
    due_[i] = slots_[i].frame % plan_.control_period == 0;
  }
  if (controller_) {
    controller_->command({.edge_angle = frame.edge_angle,
                          .edge_confidence = frame.edge_confidence,
                          .total_force = frame.total_force,
                          .center_of_pressure = frame.center_of_pressure,
                          .contact_area = frame.contact_area,
                          .start_force = start_forces_,
                          .due = due_},
                         plan_.control_period * plan_.dt, twists_);
  }
  plan_.recorder.recordFrames(frame, {.places = places_, .times = times_, .X_SO = X_SO_, .twists = twists_, .robots = &robots_});
  robots_.command(twists_, plan_.dt);

  for (int i = 0; i < num_instances; ++i) {
    if (!places_[i].columns) continue;
    Slot& slot = slots_[i];
    ++slot.frame;
    if (slot.frame < plan_.num_frames) {
      follow(i);
      ++places_[i].row;
      times_[i] = slot.frame * plan_.dt;
    } else {
      ++tally.num_episodes;
      if (std::unique_ptr<ShardBuffer> done = queue.finish(slot.place)) {
        writer.submit(std::move(done));
        queue.recycle(writer.reclaim());
      }
      startEpisode(i, queue);
    }
  }
  return tally;
}

}  // namespace taxelsim
