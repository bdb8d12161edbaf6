// A slice of the batch: instances with a simulator of their own. Each instance runs one episode after another until the sink has none left.
//
// An episode on an instance:
//
//   frame 0           The object is placed on the robot's sensor 0: load-driven (the device searches the depth) or at a given depth. If the
//                     robot has more sensors and the start is load-driven, a warm-up frame (-1) runs first: the other sensors need the pose
//                     at which the object came to rest. Warm-up frames are not passed to the sink.
//   frames 1, 2, ...  The object rests in the world or follows its trajectory; the robot moves the sensors. At its own rate, the
//                     controller reads the frame of sensor 0 and commands the twist until its next tick.
//
//   startEpisode -> submit -> collect: initialContact (first frame only) -> control -> sink -> robots move -> updatePoses -> submit -> ...
//
// The content of an episode does not depend on the instance that runs it, nor on when.
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

// Constants shared by all slices of a run.
struct EpisodePlan {
  // sink_outputs: outputs that the sinks read; those that the controllers read are added. fixed_controller: index of the controller for all
  // episodes, instead of the drawn one; everything else about the episodes is the same. `scene_to_run` must outlive this.
  EpisodePlan(const Scene& scene_to_run, const OutputOptions& sink_outputs, std::optional<int> fixed_controller = {});

  const Scene& scene;
  EpisodeDrawer drawer;
  OutputOptions outputs;
  int num_sensors;     // per robot, and simulator instances per instance of the batch
  int num_frames;      // per episode
  double dt;           // s, between frames
  int control_period;  // frames
  std::optional<int> controller;
  bool needs_contact_features = false;  // by a controller
  bool needs_jacobian = false;          // by a controller
  bool needs_true_angle = false;        // by a controller
  std::vector<TrueEdge> edges;          // (num_objects)
  bool device_clock = false;            // whether to measure Slice::Stats::device_seconds

  SimulatorOptions simulatorOptions(int num_instances) const;
};

// Not thread-safe: all calls from one thread at a time.
class Slice {
 public:
  // Statistics of one collect().
  struct Stats {
    std::uint64_t num_frames = 0;    // without warm-up frames
    std::uint64_t num_episodes = 0;  // ended
    std::uint64_t num_load_misses = 0;
    double control_seconds = 0;  // host time of controllers, robots and objects from this frame to the next
    double wait_seconds = 0;     // host time spent waiting for the device
    double device_seconds = 0;   // device time of the frame, by the device's clock; NaN if not measured
  };

  // Takes the first episode of every instance from the sink and compiles the pipelines. Throws what Simulator throws. `plan` and `sink`
  // must outlive this.
  Slice(const Model& model, const EpisodePlan& plan, int num_instances, EpisodeSink& sink);

  // Whether any instance has an episode.
  bool busy() const { return num_busy_ > 0; }

  // Submits the next frame to the device; does not wait.
  void submit();

  // Waits for the submitted frame, passes it to the sink, and advances controllers, robots and objects. Instances whose episode ended take
  // their next one from the sink.
  Stats collect();

  // Waits for the submitted frame and ignores it.
  void discard() { simulator_.read(); }

 private:
  // State of the episode that an instance runs.
  struct EpisodeState {
    EpisodeDraw draw;
    std::uint64_t episode = 0;
    int controller = 0;
    int first_frame = 0;  // 0, or -1 with a warm-up frame
    int frame = 0;
    double load_offset = 0;  // m
    bool load_reached = true;
    std::optional<Trajectory> trajectory;  // of a moving object, from its initial contact
  };

  void startEpisode(int i);
  void resetSensors(int i);
  void initialContact(int i, const FrameView& frame);
  void beginRecord(int i, const FrameView& frame);
  void control(const FrameView& frame);
  Twist actionNoise(int i) const;
  void updatePoses(int i);

  const EpisodePlan& plan_;
  EpisodeSink& sink_;
  Simulator simulator_;
  std::optional<TactileServoController> controller_;  // servo scenes only
  Robots robots_;
  int num_busy_ = 0;
  bool loads_changed_ = false;
  double submit_seconds_ = 0;

  // (num_instances x num_sensors)
  std::vector<int> ids_;
  std::vector<Pose> X_SO_;
  std::vector<float> loads_;

  // (num_instances)
  std::vector<EpisodeState> episodes_;
  std::vector<std::uint8_t> busy_;
  std::vector<std::uint8_t> recorded_;  // busy, and not in a warm-up frame
  std::vector<Pose> X_WO_;              // W: the frame of sensor 0 at the start of the episode
  std::vector<double> times_;
  std::vector<Twist> twists_;   // commanded by the controllers
  std::vector<Twist> actions_;  // with action noise
  std::vector<float> true_angles_;
  std::vector<float> start_forces_;
  std::vector<std::uint8_t> control_due_;
};

}  // namespace taxelsim
