// A slice of the batch: a batch of episodes under controllers, whose frames go to a sink. Each instance runs one episode after another
// until the sink has none left.
//
//   submit -> collect: read -> controller -> sink -> robots and objects move, ended instances take their next episode -> submit -> ...
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "episodes/controller.h"
#include "episodes/episode_batch.h"
#include "episodes/episode_sink.h"
#include "episodes/policy_controller.h"
#include "episodes/servo_controller.h"

namespace taxelsim {

// Constants shared by all slices of a run.
struct SlicePlan : EpisodePlan {
  // sink_outputs: outputs that the sinks read; those that the controllers read are added. fixed_servo: index of the scene's controller for
  // all episodes, instead of the drawn one; everything else about the episodes is the same. `scene_to_run` must outlive this.
  SlicePlan(const Scene& scene_to_run, const OutputOptions& sink_outputs, std::optional<int> fixed_servo = {});
  // The same for a policy, which must outlive this, instead of the scene's controllers. Throws Error(kInput) for a policy that cannot act
  // in the scene.
  SlicePlan(const Scene& scene_to_run, const OutputOptions& sink_outputs, const Policy& policy_to_run);

  // Null for scenes without controllers. first_instance: number of the slice's instance 0 in the whole batch. `batch` must outlive it.
  std::unique_ptr<Controller> makeController(EpisodeBatch& batch, int first_instance) const;
  // The loops that the device closes; empty where the host does.
  std::optional<ServoLoopPlan> deviceLoops(const Model& model) const;
  // Memory of a batch of num_instances x num_sensors.
  MemoryPlan memory(const Model& model, int num_instances) const;

  std::optional<ServoPlan> servos;  // servo scenes without policy only
  const Policy* policy = nullptr;
  LoopOutputs sink_reads;  // what the sinks read of FrameContext
  // Where the loops of servos are closed. kDevice: on any device that can, as far as whyOnHost() (device_servos.h) gives no reason.
  enum class Loops { kFaster, kHost, kDevice } loops = Loops::kFaster;
};

// Host work of one frame, s of processor time of the calling thread.
struct HostTimes {
  double inputs = 0;      // poses and loads are checked and passed to the simulator
  double submit = 0;      // they are packed for the device; submission
  double read = 0;        // wait, views of the outputs
  double episodes = 0;    // starts and ends of episodes, records
  double controller = 0;  // features to actions, with action noise
  double sink = 0;
  double robots = 0;
  double objects = 0;  // motion of the objects, their poses in the sensors
};

// Not thread-safe: all calls from one thread at a time.
class Slice {
 public:
  // Statistics of one collect() and the submit() before it.
  struct Stats {
    std::uint64_t num_frames = 0;    // without warm-up frames
    std::uint64_t num_episodes = 0;  // ended
    std::uint64_t num_load_misses = 0;
    double control_seconds = 0;  // host time of controllers, robots and objects from this frame to the next
    double wait_seconds = 0;     // host time spent waiting for the device
    double device_seconds = 0;   // device time of the frame, by the device's clock; NaN if not measured
    HostTimes host;
    DeviceTraffic traffic;  // from this slice's last collect() to this one; the first one has also what the first episodes set
  };

  // Takes the first episode of every instance from the sink and compiles the pipelines. Throws what Simulator throws. `plan` and `sink`
  // must outlive this. first_instance: number of the slice's instance 0 in the whole batch.
  Slice(const Model& model, const SlicePlan& plan, int num_instances, EpisodeSink& sink, int first_instance = 0);

  // Whether any instance has an episode.
  bool busy() const { return batch_.busy(); }

  // Submits the next frame to the device; does not wait.
  void submit();

  // Waits for the submitted frame, passes it to the sink, and advances controllers, robots and objects. Instances whose episode ended take
  // their next one from the sink.
  Stats collect();

  // Waits for the submitted frame and ignores it.
  void discard() { batch_.read(); }

 private:
  void startNext(int i);
  void beginRecords(Stats& stats);

  EpisodeSink& sink_;
  EpisodeBatch batch_;
  std::unique_ptr<Controller> controller_;
  double submit_seconds_ = 0;
  HostTimes host_;         // of the frame that is in flight
  DeviceTraffic traffic_;  // until the last collect()
};

}  // namespace taxelsim
