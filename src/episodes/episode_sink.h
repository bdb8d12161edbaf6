// What becomes of the frames of a slice: a data set, a verdict, a trace.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "control/robots.h"
#include "episodes/draw.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// What is known of an episode once its first frame has been read.
struct EpisodeRecord {
  std::uint64_t episode = 0;
  std::int32_t object = 0;
  float load = 0;
  std::int32_t load_driven = 0;
  float depth = 0;
  std::int32_t load_reached = 0;
  float gain = 1, gain_spread = 0, noise = 0;
  std::int32_t controller = 0;
  float exploration_velocity = 0, linear_action_noise = 0, angular_action_noise = 0;
  float start_force = 0;
};

// What a frame holds beside the simulator's outputs, which have a row for each sensor of each instance; (N) where nothing else is said.
struct FrameContext {
  std::span<const std::uint8_t> active;  // 0: the instance is idle, and has no frame
  std::span<const double> times;         // s
  int num_sensors = 1;                   // of an instance; the first is the one that is controlled
  std::span<const Pose> X_SO;            // (N x num_sensors)
  std::span<const Pose> X_WO;
  std::span<const Twist> actions;             // twists of the sensor frame that the robot is commanded after this frame
  std::span<const Twist> controller_actions;  // the same before noise
  const Robots* robots = nullptr;
};

// One of each slice; called by the slice's thread.
class EpisodeSink {
 public:
  virtual ~EpisodeSink() = default;

  // The number of the episode that an idle instance plays next; nothing when there are no more.
  virtual std::optional<std::uint64_t> next(int instance) = 0;
  // The first frame of its episode has been computed, and frame() is about to come.
  virtual void begin(int instance, const EpisodeRecord& record) = 0;
  // One frame of every instance that plays.
  virtual void frame(const FrameView& view, const FrameContext& context) = 0;
  // The frame just seen was the episode's last.
  virtual void end(int instance) = 0;
};

}  // namespace taxelsim
