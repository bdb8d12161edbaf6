// A part of the batch with its own simulator: every instance plays one episode after another until none are left. While one slice computes,
// the host works on another. What an episode holds does not depend on which instance plays it, or when.
//
//   frame 0            the object is set down: by its load (the device finds the depth) or at its depth
//   frames 1, 2, ...   the object rests in the world or goes its way, the sensor moves; the controller looks at a frame and commands the
//   way to the next
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "control/robots.h"
#include "control/tactile_servo.h"
#include "episodes/draw.h"
#include "episodes/recorder.h"
#include "episodes/shard_queue.h"
#include "episodes/shard_writer.h"
#include "taxelsim/simulator.h"
#include "taxelsim/trajectory.h"

namespace taxelsim {

// What all slices of a run share.
struct EpisodePlan {
  explicit EpisodePlan(const Scene& scene);

  const Scene& scene;
  EpisodeDrawer drawer;
  ColumnPlan columns;
  Recorder recorder;
  int num_frames;      // of an episode
  double dt;           // s, from frame to frame
  int control_period;  // frames
};

class Slice {
 public:
  // What one collect() brought.
  struct Tally {
    std::uint64_t num_frames = 0;
    std::uint64_t num_episodes = 0;  // ended
    std::uint64_t num_load_misses = 0;
  };

  // Throws what Simulator throws. `plan` must outlive this.
  Slice(const Model& model, const EpisodePlan& plan, int num_instances);

  // Gives every instance its first episode.
  void begin(ShardQueue& queue);

  // Whether any instance plays an episode.
  bool busy() const { return num_busy_ > 0; }

  // Starts the next frame; does not wait.
  void submit();

  // Waits for it, records it, moves the sensors on; hands shards that are complete to `writer` and takes new episodes from `queue`.
  Tally collect(ShardQueue& queue, ShardWriter& writer);

  // Waits for a frame that nobody will use.
  void abandon() { simulator_.read(); }

 private:
  struct Slot {
    EpisodePlace place;
    EpisodeDraw draw;
    int frame = 0;
    Pose X_WO;                             // the world is where the sensor was at the start
    std::optional<Trajectory> trajectory;  // of an object that moves on from there
  };

  void startEpisode(int i, ShardQueue& queue);
  bool settle(int i, const FrameView& frame);
  void follow(int i);

  const EpisodePlan& plan_;
  Simulator simulator_;
  std::optional<TactileServoController> controller_;  // of a servo scene
  Robots robots_;
  int num_busy_ = 0;
  bool loads_changed_ = false;

  // (num_instances) each.
  std::vector<Slot> slots_;
  std::vector<int> ids_;
  std::vector<Pose> X_SO_;
  std::vector<float> loads_;
  std::vector<FramePlace> places_;
  std::vector<double> times_;
  std::vector<Twist> twists_;
  std::vector<float> start_forces_;
  std::vector<std::uint8_t> due_;
};

}  // namespace taxelsim
