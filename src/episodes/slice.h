// A part of the batch with its own simulator: every instance plays one episode after another until none are left. While one slice computes,
// the host works on another. What an episode holds does not depend on which instance plays it, or when.
//
//   frame 0            the object is set down on the robot's first sensor: by its load (the device finds the depth) or at its depth. Where
//                      the robot has more sensors, those must wait to see where it came to rest: then a frame that nobody sees goes before
//   frames 1, 2, ...   the object rests in the world or goes its way, the sensors move; the controller looks at a frame of the first sensor
//                      and commands the way to the next
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "control/robots.h"
#include "control/tactile_servo.h"
#include "episodes/draw.h"
#include "episodes/episode_sink.h"
#include "episodes/true_edge.h"
#include "taxelsim/simulator.h"
#include "taxelsim/trajectory.h"

namespace taxelsim {

// What all slices of a run share.
struct EpisodePlan {
  // `outputs`: what the sinks read; what the controllers look at is added. `controller`: its number, for all episodes instead of what they
  // draw. Everything else in them is the same whoever controls.
  EpisodePlan(const Scene& scene, const OutputOptions& outputs, std::optional<int> controller = {});

  const Scene& scene;
  EpisodeDrawer drawer;
  OutputOptions outputs;
  int num_sensors;     // of a robot; the simulator has that many instances for one of ours
  int num_frames;      // of an episode
  double dt;           // s, from frame to frame
  int control_period;  // frames
  std::optional<int> controller;
  bool wants_contact = false;      // a controller looks at contact features,
  bool wants_jacobian = false;     // at the tactile Jacobian,
  bool wants_exact_angle = false;  // or at the true angle
  std::vector<TrueEdge> edges;     // of the objects
  bool device_clock = false;       // Stats::device_seconds is wanted

  SimulatorOptions simulatorOptions(int num_instances) const;
};

class Slice {
 public:
  // What one collect() brought.
  struct Stats {
    std::uint64_t num_frames = 0;
    std::uint64_t num_episodes = 0;  // ended
    std::uint64_t num_load_misses = 0;
    double control_seconds = 0;  // what controllers, robots and objects took on the host, from this frame to the next
    double wait_seconds = 0;     // for the device
    double device_seconds = 0;   // of the device for the frame, by its own clock; NaN where it has none or was not asked for
  };

  // Every instance takes its first episode from the sink; what the device will run is compiled. Throws what Simulator throws. `plan` and
  // `sink` must outlive this.
  Slice(const Model& model, const EpisodePlan& plan, int num_instances, EpisodeSink& sink);

  // Whether any instance plays an episode.
  bool busy() const { return num_busy_ > 0; }

  // Starts the next frame; does not wait.
  void submit();

  // Waits for it, shows it to the sink, moves the sensors on; takes new episodes from the sink where one has ended.
  Stats collect();

  // Waits for a frame that nobody will use.
  void abandon() { simulator_.read(); }

 private:
  struct Slot {
    EpisodeDraw draw;
    std::uint64_t episode = 0;
    int controller = 0;
    int first_frame = 0;  // 0, or -1: the object is set down while nobody looks
    int frame = 0;
    double load_offset = 0;
    bool load_reached = true;
    std::optional<Trajectory> trajectory;  // of an object that moves on from where it was set down
  };

  void startEpisode(int i);
  void resetSensors(int i);
  void settle(int i, const FrameView& frame);
  void announce(int i, const FrameView& frame);
  void control(const FrameView& frame);
  Twist actionNoise(int i) const;
  void follow(int i);

  const EpisodePlan& plan_;
  EpisodeSink& sink_;
  Simulator simulator_;
  std::optional<TactileServoController> controller_;  // of a servo scene
  Robots robots_;
  int num_busy_ = 0;
  bool loads_changed_ = false;
  double submit_seconds_ = 0;

  // (num_instances x num_sensors) each.
  std::vector<int> ids_;
  std::vector<Pose> X_SO_;
  std::vector<float> loads_;

  // (num_instances) each.
  std::vector<Slot> slots_;
  std::vector<std::uint8_t> busy_;
  std::vector<std::uint8_t> shown_;  // busy, and its frame is one of an episode
  std::vector<Pose> X_WO_;           // the world is where the robot's base was at the start
  std::vector<double> times_;
  std::vector<Twist> twists_;   // as the controllers want them
  std::vector<Twist> actions_;  // with noise
  std::vector<float> exact_angles_;
  std::vector<float> start_forces_;
  std::vector<std::uint8_t> due_;
};

}  // namespace taxelsim
