#include "episodes/sensed_robots.h"

#include <algorithm>
#include <cassert>

namespace taxelsim {

SensedRobots::SensedRobots(const Device& device, const Manipulator& robot, std::span<const RobotSensor> sensors,
                           const std::vector<Object>& objects, const Options& options)
    : robots_(robot, options.num_instances), num_objects_(objects.size()), places_(sensors.size()) {
  assert(sensors.size() == robot.sensors.size());
  for (std::size_t first = 0; first < sensors.size(); ++first) {
    const auto sameAsFirst = [&](const RobotSensor& sensor) { return sensor.text == sensors[first].text; };
    if (std::any_of(sensors.begin(), sensors.begin() + static_cast<std::ptrdiff_t>(first), sameAsFirst)) continue;
    std::vector<int> members;
    for (std::size_t s = first; s < sensors.size(); ++s) {
      if (!sameAsFirst(sensors[s])) continue;
      places_[s] = {groups_.size(), members.size()};
      members.push_back(static_cast<int>(s));
    }
    const std::size_t num_rows = static_cast<std::size_t>(options.num_instances) * members.size();
    OutputOptions outputs = options.outputs;
    outputs.taxel_counts = outputs.taxel_counts && sensors[first].sensor.readout.three_axis;
    Simulator simulator(Model(device, {.sensor = sensors[first].sensor, .objects = objects}), {.num_instances = static_cast<int>(num_rows),
                                                                                               .num_slots = static_cast<int>(num_objects_),
                                                                                               .seed = options.seed,
                                                                                               .outputs = outputs,
                                                                                               .max_regions = options.max_regions});
    groups_.push_back({std::move(members), std::move(simulator), std::vector<Pose>(num_rows * num_objects_)});
    if (ids_.size() < num_rows * num_objects_) ids_.resize(num_rows * num_objects_);
  }
  for (std::size_t k = 0; k < ids_.size(); ++k) ids_[k] = static_cast<int>(k % num_objects_);
}

void SensedRobots::reset(int instance, std::uint64_t episode, std::span<const ReadoutVariation> variations) {
  robots_.reset(instance);
  const auto num_sensors = static_cast<std::uint64_t>(numSensors());
  for (int s = 0; s < numSensors(); ++s) {
    groups_[places_[static_cast<std::size_t>(s)].group].simulator.reset(
        static_cast<int>(row(s, instance)), episode * num_sensors + static_cast<std::uint64_t>(s), variations[static_cast<std::size_t>(s)]);
  }
}

void SensedRobots::step(double dt, std::span<const Pose> X_WO, std::span<const std::uint8_t> instances) {
  const std::span<const Pose> X_WS = robots_.X_WS();
  for (int i = 0; i < numInstances(); ++i) {
    for (int s = 0; s < numSensors(); ++s) {
      const Pose X_SW = inverse(X_WS[static_cast<std::size_t>(i) * places_.size() + static_cast<std::size_t>(s)]);
      Pose* const out = groups_[places_[static_cast<std::size_t>(s)].group].X_SO.data() + row(s, i) * num_objects_;
      for (std::size_t k = 0; k < num_objects_; ++k) out[k] = X_SW * X_WO[static_cast<std::size_t>(i) * num_objects_ + k];
    }
  }
  for (Group& group : groups_) {
    group.simulator.setObjects(std::span(ids_).first(group.X_SO.size()), group.X_SO);
    if (instances.empty()) {
      group.simulator.step(dt);
      continue;
    }
    rows_.clear();
    for (const std::uint8_t computed : instances) rows_.insert(rows_.end(), group.sensors.size(), computed);
    group.simulator.step(dt, rows_);
  }
  for (Group& group : groups_) group.frame = group.simulator.read();
}

}  // namespace taxelsim
