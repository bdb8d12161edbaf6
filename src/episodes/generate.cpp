#include "taxelsim/generate.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "episodes/slice.h"
#include "taxelsim/error.h"
#include "taxelsim/version.h"

namespace taxelsim {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kProgressPeriod = std::chrono::milliseconds(250);

void checkCount(const char* name, std::uint64_t value) {
  if (value < 1) throw Error(ErrorKind::kInput, std::string(name) + ": " + std::to_string(value) + " found, at least 1 allowed");
}

// A scene need not come from loadScene().
void checkRun(const Scene& scene, const GenerateOptions& options) {
  checkCount("batch size", static_cast<std::uint64_t>(std::max(options.batch_size, 0)));
  checkCount("slices", static_cast<std::uint64_t>(std::max(options.num_slices, 0)));
  checkCount("episodes", scene.num_episodes);
  checkCount("episodes_per_shard", scene.episodes_per_shard);
  checkCount("num_steps", static_cast<std::uint64_t>(std::max(scene.num_steps, 0)));
  checkCount("objects", scene.objects.size());
  checkRobot(scene.robot);
  if (const auto* manipulator = std::get_if<Manipulator>(&scene.robot); manipulator != nullptr && manipulator->sensors.size() > 1) {
    throw Error(ErrorKind::kInput, scene.file.generic_string() + ": robot.sensors: " + std::to_string(manipulator->sensors.size()) +
                                       " sensors, generate simulates 1 of each robot; several arrays are patches of one sensor");
  }
  for (const SceneObject& entry : scene.objects) {
    checkObject(entry.object);
    if (entry.motion) checkMotion(*entry.motion);
  }
  checkSensor(scene.sensor);
}

// Shards that one batch keeps in memory: those its episodes span, with a part of one at either end.
std::uint64_t numShardsUnderWay(const Scene& scene, const GenerateOptions& options) {
  const std::uint64_t batch_size = std::min<std::uint64_t>(options.batch_size, scene.num_episodes);
  return std::min(batch_size / scene.episodes_per_shard + 2, (scene.num_episodes - 1) / scene.episodes_per_shard + 1);
}

// Linux promises more memory than there is and kills who takes it, so it is asked beforehand. In double: the product may pass 2^64.
void checkHostMemory(const Scene& scene, const GenerateOptions& options) {
  double episode_bytes = 0;
  for (const Column& column : columnsOf(scene)) {
    episode_bytes += static_cast<double>(rowBytes(column)) * (column.per_episode ? 1 : numFrames(scene));
  }
  const double episodes = static_cast<double>(std::min(scene.episodes_per_shard, scene.num_episodes));
  const double need = static_cast<double>(numShardsUnderWay(scene, options)) * episodes * episode_bytes;
  const double have = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  if (need <= have) return;
  const auto mebibytes = [](double bytes) { return std::to_string(static_cast<long long>(std::min(bytes / 0x1p20, 9e18))) + " MiB"; };
  throw Error(ErrorKind::kInput, "shards under way of " + std::to_string(scene.episodes_per_shard) + " episodes of " +
                                     std::to_string(numFrames(scene)) + " frames take " + mebibytes(need) + " of memory, " +
                                     mebibytes(have) + " there are; make episodes_per_shard, num_steps or the batch smaller");
}

Manifest manifestOf(const Scene& scene, const Device& device) {
  const bool one_grid = scene.sensor.patches.size() == 1;
  return {.scene = scene.resolved,
          .sensor_name = scene.sensor.name,
          .num_rows = one_grid ? scene.sensor.patches[0].num_rows : 0,
          .num_cols = one_grid ? scene.sensor.patches[0].num_cols : 0,
          .pitch = one_grid ? scene.sensor.patches[0].pitch : std::array<double, 2>{0, 0},
          .seed = scene.seed,
          .num_episodes = scene.num_episodes,
          .episodes_per_shard = scene.episodes_per_shard,
          .compression = scene.compression,
          .program_version = kVersion,
          .device = device.info().name + ", " + device.info().driver,
          .columns = columnsOf(scene)};
}

ModelOptions modelOptionsOf(const Scene& scene) {
  ModelOptions options{.sensor = scene.sensor, .objects = {}};
  for (const SceneObject& object : scene.objects) options.objects.push_back(object.object);
  return options;
}

// Instances of each slice; no slice is empty. Each simulator checks its own part against the device; together they must fit as well.
std::vector<int> cutBatch(const Model& model, const EpisodePlan& plan, int batch_size, int num_slices) {
  num_slices = std::min(num_slices, batch_size);
  const MemoryPlan memory = Simulator::plan(model, {.num_instances = batch_size,
                                                    .num_slots = 1,
                                                    .seed = plan.scene.seed,
                                                    .outputs = plan.columns.outputs,
                                                    .max_regions = plan.columns.max_regions});
  const std::uint64_t have = model.device().info().memory;
  const std::uint64_t fixed = memory.bytes_fixed * static_cast<std::uint64_t>(num_slices);
  const std::uint64_t need = fixed + memory.bytes_per_instance * static_cast<std::uint64_t>(batch_size);
  if (need > have) {
    const std::uint64_t fits = have > fixed ? (have - fixed) / std::max<std::uint64_t>(memory.bytes_per_instance, 1) : 0;
    throw Error(ErrorKind::kInput, "batch size: " + std::to_string(batch_size) + " instances in " + std::to_string(num_slices) +
                                       " slices take " + std::to_string(need) + " bytes of device memory, " + std::to_string(have) +
                                       " there are; at most " + std::to_string(fits) + " fit");
  }
  std::vector<int> sizes;
  for (int s = 0; s < num_slices; ++s) sizes.push_back(batch_size / num_slices + (s < batch_size % num_slices ? 1 : 0));
  return sizes;
}

// The state of one generate() call.
class Run {
 public:
  Run(const GenerateOptions& options, DatasetWriter& writer, const Manifest& manifest) : options_(options), writer_(writer) {
    complete_.resize(manifest.numShards());
    progress().num_episodes = manifest.num_episodes;
    for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard) {
      complete_[shard] = writer.isComplete(shard);
      if (!complete_[shard]) continue;
      const std::uint64_t first = shard * manifest.episodes_per_shard;
      progress().episodes_resumed += std::min(manifest.episodes_per_shard, manifest.num_episodes - first);
    }
    progress().episodes_done = progress().episodes_resumed;
  }

  const std::vector<bool>& complete() const { return complete_; }
  Progress& progress() { return result_.progress; }

  void simulate(const Model& model, const EpisodePlan& plan, ShardQueue& queue);

  GenerateResult end() {
    result_.complete = progress().episodes_done == progress().num_episodes;
    if (result_.complete) writer_.finish();
    if (options_.on_progress) options_.on_progress(progress());
    return result_;
  }

 private:
  bool stopped() const { return options_.stop && options_.stop->load(std::memory_order_relaxed); }
  void loop(std::vector<std::unique_ptr<Slice>>& slices, ShardQueue& queue, ShardWriter& shard_writer);
  void report(Clock::time_point now);

  const GenerateOptions& options_;
  DatasetWriter& writer_;
  std::vector<bool> complete_;
  GenerateResult result_;
  Clock::time_point start_;
  Clock::time_point last_report_;
};

void Run::report(Clock::time_point now) {
  progress().seconds = std::chrono::duration<double>(now - start_).count();
  if (!options_.on_progress || now - last_report_ < kProgressPeriod) return;
  last_report_ = now;
  options_.on_progress(progress());
}

// Slices take turns. When a slice's turn comes its frame is read and its next one started; meanwhile the others' frames are computed.
void Run::loop(std::vector<std::unique_ptr<Slice>>& slices, ShardQueue& queue, ShardWriter& shard_writer) {
  for (const auto& slice : slices) {
    slice->begin(queue);
    if (slice->busy()) slice->submit();
  }
  bool any_busy = true;
  while (any_busy) {
    any_busy = false;
    for (const auto& slice : slices) {
      if (!slice->busy()) continue;
      if (stopped()) {
        for (const auto& other : slices) {
          if (other->busy()) other->abandon();
        }
        return;
      }
      const Slice::Tally tally = slice->collect(queue, shard_writer);
      progress().frames_done += tally.num_frames;
      progress().episodes_done += tally.num_episodes;
      result_.num_load_misses += tally.num_load_misses;
      if (slice->busy()) {
        slice->submit();
        any_busy = true;
      }
      report(Clock::now());
    }
  }
}

void Run::simulate(const Model& model, const EpisodePlan& plan, ShardQueue& queue) {
  const int batch_size = static_cast<int>(std::min<std::uint64_t>(options_.batch_size, queue.numEpisodesLeft()));
  std::vector<std::unique_ptr<Slice>> slices;
  for (const int size : cutBatch(model, plan, batch_size, options_.num_slices)) {
    slices.push_back(std::make_unique<Slice>(model, plan, size));
  }
  // Episodes of a batch end together, so as many shards can come at once as the batch spans; the device need not wait for them.
  start_ = last_report_ = Clock::now();
  ShardWriter shard_writer(writer_, numShardsUnderWay(plan.scene, options_));
  loop(slices, queue, shard_writer);
  shard_writer.close();
  progress().episodes_done = progress().episodes_resumed + shard_writer.numEpisodesWritten();
  progress().seconds = std::chrono::duration<double>(Clock::now() - start_).count();
}

}  // namespace

GenerateResult generate(const Device& device, const Scene& scene, const std::filesystem::path& directory, const GenerateOptions& options) {
  checkRun(scene, options);
  checkHostMemory(scene, options);
  const EpisodePlan plan(scene);
  const Manifest manifest = manifestOf(scene, device);
  // What cannot run leaves no directory behind.
  const Model model(device, modelOptionsOf(scene));
  cutBatch(model, plan, static_cast<int>(std::min<std::uint64_t>(options.batch_size, scene.num_episodes)), options.num_slices);
  DatasetWriter writer(directory, manifest);
  Run run(options, writer, manifest);
  ShardQueue queue(manifest, run.complete(), plan.num_frames);
  if (queue.numEpisodesLeft() > 0) run.simulate(model, plan, queue);
  return run.end();
}

}  // namespace taxelsim
