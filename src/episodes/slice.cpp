#include "episodes/slice.h"

#include <chrono>
#include <ctime>
#include <string>
#include <utility>

#include "episodes/device_servos.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

class Stopwatch {
 public:
  // Seconds since construction or the preceding lap().
  double lap() {
    const SteadyClock::time_point now = SteadyClock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  using SteadyClock = std::chrono::steady_clock;
  SteadyClock::time_point last_ = SteadyClock::now();
};

// Processor time of the calling thread.
class ThreadStopwatch {
 public:
  // Seconds since construction or the preceding lap(); 0 where the system has no such clock.
  double lap() {
    const double now = seconds();
    return now - std::exchange(last_, now);
  }

 private:
  static double seconds() {
    timespec time{};
    return ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time) == 0
               ? static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec)
               : 0.0;
  }
  double last_ = seconds();
};

DeviceTraffic operator-(const DeviceTraffic& a, const DeviceTraffic& b) {
  return {a.num_submits - b.num_submits, a.bytes_to_device - b.bytes_to_device, a.bytes_from_device - b.bytes_from_device};
}

}  // namespace

SlicePlan::SlicePlan(const Scene& scene_to_run, const OutputOptions& sink_outputs, std::optional<int> fixed_servo)
    : EpisodePlan(scene_to_run, sink_outputs, numRegions(scene_to_run)) {
  if (scene.kind != Scene::Kind::kServo) return;
  servos.emplace(scene, fixed_servo);
  servos->addOutputs(outputs);
}

SlicePlan::SlicePlan(const Scene& scene_to_run, const OutputOptions& sink_outputs, const Policy& policy_to_run)
    : EpisodePlan(scene_to_run, sink_outputs | policy_to_run.outputs, policy_to_run.max_regions), policy(&policy_to_run) {
  checkPolicy(*policy, scene);
  if (!hasContactFeatures(sink_outputs)) return;
  // The sinks read as many rows as the scene has regions.
  max_regions = numRegions(scene);
  if (hasContactFeatures(policy->outputs) && policy->max_regions != max_regions) {
    throw Error(ErrorKind::kInput, "policy " + policy->name + ": max_regions: " + std::to_string(policy->max_regions) +
                                       " is not allowed: the scene records contact features with " + std::to_string(max_regions));
  }
}

std::unique_ptr<Controller> SlicePlan::makeController(EpisodeBatch& batch, int first_instance) const {
  if (policy) return std::make_unique<PolicyController>(*policy, *this, batch.numInstances(), first_instance);
  if (!servos) return nullptr;
  if (ServoLoop* const loop = batch.deviceLoop()) return std::make_unique<DeviceServoController>(*servos, *this, *loop);
  return std::make_unique<ServoController>(*servos, *this, batch.numInstances());
}

std::optional<ServoLoopPlan> SlicePlan::deviceLoops(const Model& model) const {
  if (!(loops == Loops::kDevice ? ServoLoop::isSupported(model) : loops == Loops::kFaster && ServoLoop::isFaster(model))) return {};
  if (!whyOnHost(*this).empty()) return {};
  ServoLoopPlan plan{.servos = {},
                     .dt = dt,
                     .control_period = control_period,
                     .starts_at_load = starts_at_load,
                     .reads_contact_features = servos->needs_contact_features,
                     .outputs = sink_reads,
                     .robot = loopRobotOf(scene.robot)};
  for (const SceneController& controller : scene.controllers) plan.servos.push_back(controller.servo);
  return plan;
}

MemoryPlan SlicePlan::memory(const Model& model, int num_instances) const {
  const std::optional<ServoLoopPlan> device_loops = deviceLoops(model);
  const SimulatorOptions options = simulatorOptions(num_instances);
  return device_loops ? ServoLoop::planMemory(model, options, *device_loops) : Simulator::plan(model, options);
}

Slice::Slice(const Model& model, const SlicePlan& plan, int num_instances, EpisodeSink& sink, int first_instance)
    : sink_(sink), batch_(model, plan, num_instances, plan.deviceLoops(model)), controller_(plan.makeController(batch_, first_instance)) {
  for (int i = 0; i < num_instances; ++i) startNext(i);
  batch_.prepare();
}

void Slice::startNext(int i) {
  const std::optional<std::uint64_t> episode = sink_.next(i);
  if (!episode) return batch_.stop(i);
  const EpisodeDraw draw = batch_.plan().drawer.draw(*episode);
  batch_.start(i, *episode, draw);
  if (controller_) controller_->start(i, draw);
}

void Slice::submit() {
  Stopwatch stopwatch;
  ThreadStopwatch processor;
  batch_.setInputs();
  submit_seconds_ = stopwatch.lap();
  host_.inputs = processor.lap();
  batch_.submit();
  host_.submit = processor.lap();
}

// Passes the constants of new episodes to the sink.
void Slice::beginRecords(Stats& stats) {
  for (int i = 0; i < batch_.numInstances(); ++i) {
    if (!batch_.active()[i]) continue;
    ++stats.num_frames;
    if (batch_.frameNumbers()[i] != 0) continue;
    EpisodeRecord record = batch_.record(i);
    if (controller_) controller_->describe(i, record);
    if (record.load_reached == 0) ++stats.num_load_misses;
    sink_.begin(i, record);
  }
}

Slice::Stats Slice::collect() {
  Stopwatch stopwatch;
  ThreadStopwatch processor;
  batch_.read();
  Stats stats{.control_seconds = submit_seconds_,
              .wait_seconds = stopwatch.lap(),
              .device_seconds = batch_.timeOfFrame(),
              .host = host_,
              .traffic = batch_.traffic() - traffic_};
  traffic_ = batch_.traffic();
  stats.host.read = processor.lap();

  batch_.beginFrame();
  beginRecords(stats);
  stats.host.episodes = processor.lap();
  if (controller_) controller_->command(batch_);
  stats.host.controller = processor.lap();
  stats.control_seconds += stopwatch.lap();
  sink_.frame(batch_.frame(), batch_.context());
  stats.host.sink = processor.lap();
  stopwatch.lap();

  batch_.moveRobots();
  stats.host.robots = processor.lap();
  batch_.moveObjects();
  stats.host.objects = processor.lap();
  for (int i = 0; i < batch_.numInstances(); ++i) {
    if (!batch_.hasEnded(i)) continue;
    ++stats.num_episodes;
    sink_.end(i);
    startNext(i);
  }
  stats.host.episodes += processor.lap();
  stats.control_seconds += stopwatch.lap();
  return stats;
}

}  // namespace taxelsim
