// State of episodes in addition to the outputs of the simulator.
#pragma once

#include <cstdint>
#include <span>

#include "base/thread_team.h"
#include "scene/skin_ranges.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// Constants of an episode, known once its first frame has been read. Units as the data set columns meta/*.
struct EpisodeRecord {
  std::uint64_t episode = 0;
  std::int32_t object = 0;
  float load = 0;  // N
  std::int32_t load_driven = 0;
  float depth = 0;  // m, after the load search
  std::int32_t load_reached = 0;
  float gain = 1, gain_spread = 0, noise = 0;
  std::int32_t controller = 0;
  float exploration_velocity = 0, linear_action_noise = 0, angular_action_noise = 0;  // m/s, m/s, rad/s
  SkinVariation skin = {};
  Mounting mounting = {};
  float start_force = 0;  // N: the force that a controller holds by default
};

// State of a frame in addition to the outputs of the simulator. Arrays have shape (num_instances) unless noted; the simulator's outputs
// have num_sensors rows per instance. Poses, actions, status and joints are empty if the sink does not read them (SlicePlan::sink_reads).
struct FrameContext {
  std::span<const std::uint8_t> active;  // 0: the instance is idle, and its rows are undefined
  std::span<const double> times;         // s, since the start of the episode
  int num_sensors = 1;                   // per instance; sensor 0 is the one in the control loop
  std::span<const Pose> X_SO;            // (num_instances x num_sensors)
  std::span<const Pose> X_WO;
  std::span<const Twist> actions;              // twist of the sensor frame commanded to the robot after this frame
  std::span<const Twist> controller_actions;   // the same before action noise
  std::span<const Pose> X_WS;                  // (num_instances x num_sensors)
  std::span<const double> joint_positions;     // (num_instances x num_joints), rad or m
  std::span<const double> joint_velocities;    // likewise, per s
  std::span<const std::uint8_t> robot_status;  // flags of RobotStatus (control/robots.h), of the motion that led to the frame
  ThreadTeam* team = nullptr;                  // threads that share loops over the instances; null: there are none

  // Calls job(first, last) for parts of [0, num_instances), as ThreadTeam::run().
  template <typename Job>
  void share(std::size_t num_instances, const Job& job) const {
    const int count = static_cast<int>(num_instances);
    team != nullptr ? team->run(count, job) : job(0, count);
  }
};

}  // namespace taxelsim
