#include "taxelsim/generate.h"

#include <algorithm>
#include <chrono>
#include <climits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/memory.h"
#include "base/processors.h"
#include "episodes/batch.h"
#include "episodes/contact_misses.h"
#include "generation/generate_grasp.h"
#include "generation/generate_loops.h"
#include "generation/grasp_columns.h"
#include "generation/loop_outputs.h"
#include "generation/probe.h"
#include "generation/shard_run.h"
#include "generation/shard_sink.h"
#include "scene/scene_checks.h"
#include "taxelsim/error.h"
#include "taxelsim/version.h"

namespace taxelsim {
namespace {

using SteadyClock = std::chrono::steady_clock;

// Of the data set.
std::uint64_t numEpisodes(const Scene& scene, const GenerateOptions& options) {
  return options.episodes.empty() ? scene.num_episodes : options.episodes.size();
}

void checkRun(const Scene& scene, const GenerateOptions& options) {
  checkCount("batch size", options.batch_size);
  checkCount("slices", options.num_slices);
  checkCount("processes", options.num_processes);
  checkScene(scene);
  if (options.policy && options.policy->id.empty()) {
    throw Error(ErrorKind::kInput, "policy " + options.policy->name + ": the id is empty, which a data set needs");
  }
  std::vector<std::uint64_t> episodes = options.episodes;
  std::sort(episodes.begin(), episodes.end());
  const auto twice = std::adjacent_find(episodes.begin(), episodes.end());
  if (twice != episodes.end()) throw Error(ErrorKind::kInput, "episodes: " + std::to_string(*twice) + " found twice");
  if (scene.contact_points && !episodes.empty() && episodes.back() >= scene.contact_points->num_episodes) {
    throw Error(ErrorKind::kInput, "episodes: " + std::to_string(episodes.back()) + " is not allowed: 0 to " +
                                       std::to_string(scene.contact_points->num_episodes - 1) + ", those of " +
                                       scene.contact_points->file_name);
  }
}

// Largest number of shards in memory: those that the episodes of one batch span, with a partial one at either end.
std::uint64_t maxOpenShards(const Scene& scene, const GenerateOptions& options) {
  const std::uint64_t batch_size = std::min<std::uint64_t>(options.batch_size, numEpisodes(scene, options));
  return std::min(batch_size / scene.episodes_per_shard + 2, (numEpisodes(scene, options) - 1) / scene.episodes_per_shard + 1);
}

// Threads that write shards. Hashing a shard takes longer than its way to the disk.
int writerThreads(const GenerateOptions& options) {
  constexpr int kMost = 8;
  return std::clamp(usableProcessors() / options.num_processes, 1, kMost);
}

// Bytes of the unfinished shards. In double: the product may exceed 2^64.
double openShardBytes(const Scene& scene, const std::vector<Column>& columns, const GenerateOptions& options) {
  double episode_bytes = 0;
  for (const Column& column : columns) {
    episode_bytes += static_cast<double>(rowBytes(column)) * (column.per_episode ? 1 : numFrames(scene));
  }
  const double episodes = static_cast<double>(std::min(scene.episodes_per_shard, numEpisodes(scene, options)));
  return static_cast<double>(maxOpenShards(scene, options)) * episodes * episode_bytes;
}

// Checked in advance, because Linux overcommits memory and kills the process later, as it does with a control group beyond its limit.
void checkHostMemory(const Scene& scene, const std::vector<Column>& columns, const GenerateOptions& options) {
  const double needed = openShardBytes(scene, columns, options);
  const double available = static_cast<double>(usableMemory()) / options.num_processes;
  if (needed <= available) return;
  const auto mebibytes = [](double bytes) { return std::to_string(static_cast<long long>(std::min(bytes / 0x1p20, 9e18))) + " MiB"; };
  throw Error(ErrorKind::kInput, "open shards of " + std::to_string(scene.episodes_per_shard) + " episodes with " +
                                     std::to_string(numFrames(scene)) + " frames need " + mebibytes(needed) + " of memory, " +
                                     mebibytes(available) + " are available; reduce episodes_per_shard, num_steps" +
                                     (options.num_processes > 1 ? ", the batch size or the number of processes" : " or the batch size"));
}

Manifest manifestOf(const Scene& scene, std::vector<Column> columns, const Device& device, const GenerateOptions& options) {
  const bool is_grasp = scene.kind == Scene::Kind::kGrasp;
  const bool one_grid = !is_grasp && scene.sensor.patches.size() == 1;
  return {.format_version = kDatasetFormat,
          .scene = scene.resolved,
          .sensor_name = is_grasp ? sensorNames(*scene.grasp) : scene.sensor.name,
          .num_rows = one_grid ? scene.sensor.patches[0].num_rows : 0,
          .num_cols = one_grid ? scene.sensor.patches[0].num_cols : 0,
          .pitch = one_grid ? scene.sensor.patches[0].pitch : std::array<double, 2>{0, 0},
          .seed = scene.seed,
          .num_episodes = numEpisodes(scene, options),
          .episodes = options.episodes,
          .episodes_per_shard = scene.episodes_per_shard,
          .compression = scene.compression,
          .chunk_bytes = scene.chunk_bytes,
          .program_version = kVersion,
          .device = deviceText(device.info()),
          .policy = options.policy ? options.policy->id : "",
          .columns = std::move(columns)};
}

// Makes the shards that this process can claim now.
void simulate(ShardRun& run, DatasetWriter& writer, const Manifest& manifest, const Model& model, const SlicePlan& plan,
              const Recorder& recorder, const GenerateOptions& options) {
  ShardQueue queue(manifest, run.complete(), plan.num_frames, [&writer](std::uint64_t shard) { return writer.claim(shard); });
  const int batch_size = static_cast<int>(std::min<std::uint64_t>(options.batch_size, queue.numEpisodesLeft()));
  // All episodes of a batch end at the same time, and with them up to maxOpenShards() shards: the queue takes them without blocking.
  ShardWriter shard_writer(writer, maxOpenShards(plan.scene, options), writerThreads(options));
  GenerateResult& result = run.result();
  result.load_misses.resize(plan.scene.objects.size());
  result.contact_misses.resize(1);
  ContactMissCounter contact_misses(plan, result.contact_misses[0]);
  std::vector<std::unique_ptr<ShardSink>> sinks;
  std::vector<std::unique_ptr<Slice>> slices;
  int first_instance = 0;
  for (const int size : splitBatch(model, plan, batch_size, options.num_slices)) {
    sinks.push_back(std::make_unique<ShardSink>(plan, recorder, queue, shard_writer, result.load_misses, contact_misses, size));
    slices.push_back(std::make_unique<Slice>(model, plan, size, *sinks.back(), first_instance));
    first_instance += size;
  }
  run.restartClock();
  runEpisodes(model.device(), slices, options.stop, [&](const Slice::Stats& stats) {
    result.progress.frames_done += stats.num_frames;
    result.progress.episodes_done += stats.num_episodes;
    result.num_load_misses += stats.num_load_misses;
    result.times.device_busy += stats.device_seconds;
    result.times.device_wait += stats.wait_seconds;
    run.report();
  });
  const SteadyClock::time_point last_frame = SteadyClock::now();
  shard_writer.close();
  result.times.writing_last += std::chrono::duration<double>(SteadyClock::now() - last_frame).count();
  result.times.writer_wait += shard_writer.secondsWaited();
  run.addWritten(shard_writer.numEpisodesWritten());
}

}  // namespace

GenerateResult generate(const Device& device, const Scene& scene, const std::filesystem::path& directory, const GenerateOptions& options) {
  return generate(device, scene, directory, options, SlicePlan::Loops::kFaster);
}

GenerateResult generate(const Device& device, const Scene& scene, const std::filesystem::path& directory, const GenerateOptions& options,
                        SlicePlan::Loops loops) {
  checkRun(scene, options);
  const bool is_grasp = scene.kind == Scene::Kind::kGrasp;
  const ColumnPlan columns = is_grasp ? ColumnPlan{} : planColumns(scene);
  Manifest manifest = manifestOf(scene, is_grasp ? graspColumns(scene) : columns.columns(), device, options);
  checkHostMemory(scene, manifest.columns, options);
  if (is_grasp) return generateGrasp(device, scene, directory, std::move(manifest), options);
  SlicePlan plan = options.policy ? SlicePlan(scene, outputsOf(scene), *options.policy) : SlicePlan(scene, outputsOf(scene));
  plan.device_clock = options.device_clock;
  plan.sink_reads = loopOutputsOf(scene, columns);
  plan.loops = loops;
  const Recorder recorder(columns, plan.edges);
  // Model and batch are checked before the directory is created.
  const Model model(device, modelOptionsOf(scene));
  const std::uint64_t team_size = static_cast<std::uint64_t>(options.batch_size) * static_cast<std::uint64_t>(options.num_processes);
  splitBatch(model, plan, static_cast<int>(std::min<std::uint64_t>({team_size, manifest.num_episodes, INT_MAX})), options.num_slices);
  manifest.probe_sha256 = probeHash(model, scene, columns);
  DatasetWriter writer(directory, manifest, writerOptions(options));
  if (!writer.isVerified()) return unverifiedResult(manifest);
  ShardRun run(options, writer, manifest, plan.num_frames);
  run.simulateAll([&] { simulate(run, writer, manifest, model, plan, recorder, options); });
  GenerateResult result = run.end();
  if (options.num_processes == 1) warnOfContactMisses(scene, result.contact_misses);
  return result;
}

}  // namespace taxelsim
