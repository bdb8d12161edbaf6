// A batch of equal robots with several sensors, each with its own sensor file, among objects that all sensors can touch. Poses of sensors
// come from the joints; the caller moves joints and objects.
//
// Sensors with equal settings share one Model and one Simulator, which has a row for each of them in each instance. Each sensor of each
// episode has noise of its own. An instance has the same bits in any batch. Not thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "control/robots.h"
#include "taxelsim/grasp.h"
#include "taxelsim/object.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

class SensedRobots {
 public:
  struct Options {
    int num_instances = 1;
    std::uint64_t seed = 0;
    OutputOptions outputs{};
    int max_regions = 0;
  };

  // sensors (robot.sensors.size()). objects: 1 to kMaxSlots, in every instance. Throws what Model and Simulator throw.
  SensedRobots(const Device& device, const Manipulator& robot, std::span<const RobotSensor> sensors, const std::vector<Object>& objects,
               const Options& options);

  Robots& robots() { return robots_; }
  const Robots& robots() const { return robots_; }
  int numInstances() const { return robots_.numInstances(); }
  int numSensors() const { return robots_.numSensors(); }

  // Starts an episode of an instance at the initial posture of the robot. variations (num_sensors).
  void reset(int instance, std::uint64_t episode, std::span<const ReadoutVariation> variations);

  // Computes the frame of all sensors. X_WO (num_instances x num_objects). Submits and waits.
  //
  // `instances` (num_instances): not 0 for the instances that have been reset and are computed, while all others hold; empty: all.
  void step(double dt, std::span<const Pose> X_WO, std::span<const std::uint8_t> instances = {});

  // Frame of the group that has the sensor, and the row of the sensor in it. Valid until the next step().
  const FrameView& frame(int sensor) const { return groups_[places_[static_cast<std::size_t>(sensor)].group].frame; }
  std::size_t row(int sensor, int instance) const {
    const Place& place = places_[static_cast<std::size_t>(sensor)];
    return static_cast<std::size_t>(instance) * groups_[place.group].sensors.size() + place.index;
  }
  std::size_t numRows(int sensor) const { return row(sensor, numInstances()) - row(sensor, 0); }

 private:
  struct Group {
    std::vector<int> sensors;
    Simulator simulator;
    std::vector<Pose> X_SO;  // (num_instances x sensors.size() x num_objects)
    FrameView frame{};
  };
  struct Place {
    std::size_t group, index;
  };

  Robots robots_;
  std::size_t num_objects_;
  std::vector<Group> groups_;
  std::vector<Place> places_;       // (num_sensors)
  std::vector<int> ids_;            // objects of all slots of the largest group
  std::vector<std::uint8_t> rows_;  // rows of a group that are computed
};

}  // namespace taxelsim
