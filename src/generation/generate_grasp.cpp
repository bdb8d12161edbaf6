#include "generation/generate_grasp.h"

#include <algorithm>
#include <chrono>
#include <vector>

#include "base/sha256.h"
#include "generation/grasp_columns.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr int kProbeFrames = 2;  // the initial contact and one that depends on the frame before

void refuseOptions(const Scene& scene, const GenerateOptions& options) {
  const auto refuse = [&](bool given, const char* what) {
    if (given) throw Error(ErrorKind::kInput, scene.file.generic_string() + ": a scene of kind grasp takes no " + what);
  };
  refuse(options.policy.has_value(), "policy");
  refuse(options.shards.has_value(), "range of shards: it is written by one process");
  refuse(static_cast<bool>(options.workers.start), "workers: it is written by one process");
  refuse(!options.episodes.empty(), "list of episodes");
}

class GraspRun {
 public:
  GraspRun(const Device& device, const Scene& scene, const Manifest& manifest, const GenerateOptions& options)
      : manifest_(manifest),
        options_(options),
        recorder_(scene),
        batch_(device, scene, outputsOf(scene),
               static_cast<int>(std::min({static_cast<std::uint64_t>(options.batch_size), scene.num_episodes, scene.episodes_per_shard}))) {
  }

  // Episodes first, ..., first + count - 1 as a shard. Empty columns after a stop.
  ShardData simulate(std::uint64_t first, std::uint64_t count, int num_frames, Progress& progress);

 private:
  bool isStopped() const { return options_.stop != nullptr && *options_.stop; }
  void simulateBatch(std::uint64_t first, int count, std::uint64_t first_row, int num_frames, std::span<std::byte* const> columns,
                     Progress& progress);

  const Manifest& manifest_;
  const GenerateOptions& options_;
  GraspRecorder recorder_;
  GraspBatch batch_;
};

ShardData GraspRun::simulate(std::uint64_t first, std::uint64_t count, int num_frames, Progress& progress) {
  ShardData data{.episode_lengths = std::vector<std::uint64_t>(count, static_cast<std::uint64_t>(num_frames)), .columns = {}};
  std::vector<std::byte*> columns;
  for (const Column& column : manifest_.columns) {
    const std::uint64_t num_rows = column.per_episode ? count : count * static_cast<std::uint64_t>(num_frames);
    columns.push_back(data.columns.emplace_back(num_rows * rowBytes(column)).data());
  }
  for (std::uint64_t row = 0; row < count && !isStopped();) {
    const int size = static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(batch_.numInstances()), count - row));
    simulateBatch(first + row, size, row, num_frames, columns, progress);
    row += static_cast<std::uint64_t>(size);
  }
  if (isStopped()) data.columns.clear();
  return data;
}

void GraspRun::simulateBatch(std::uint64_t first, int count, std::uint64_t first_row, int num_frames, std::span<std::byte* const> columns,
                             Progress& progress) {
  batch_.begin(first, count);
  recorder_.recordEpisodes(batch_, first, count, columns, first_row);
  std::vector<std::uint64_t> rows(static_cast<std::size_t>(count));
  for (int frame = 0; frame < num_frames && !isStopped(); ++frame) {
    batch_.step();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i] = (first_row + i) * static_cast<std::uint64_t>(num_frames) + static_cast<std::uint64_t>(frame);
    }
    recorder_.recordFrames(batch_, count, columns, rows);
    progress.frames_done += static_cast<std::uint64_t>(count);
  }
}

std::string probeOf(GraspRun& run) {
  Progress unused;
  Sha256 digest;
  for (const std::vector<std::byte>& column : run.simulate(0, 1, kProbeFrames, unused).columns) digest.add(column);
  return digest.finish();
}

}  // namespace

GenerateResult generateGrasp(const Device& device, const Scene& scene, const std::filesystem::path& directory, Manifest manifest,
                             const GenerateOptions& options) {
  using SteadyClock = std::chrono::steady_clock;
  refuseOptions(scene, options);
  GraspRun run(device, scene, manifest, options);
  manifest.probe_sha256 = probeOf(run);
  DatasetWriter writer(directory, manifest, {.repair = options.repair, .on_verify = options.on_verify, .stop = options.stop});
  GenerateResult result;
  Progress& progress = result.progress;
  progress.num_episodes = manifest.num_episodes;
  result.verified = writer.isVerified();
  if (!result.verified) return result;
  const auto episodesOf = [&](std::uint64_t shard) {
    return std::min(manifest.episodes_per_shard, manifest.num_episodes - shard * manifest.episodes_per_shard);
  };
  for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard) {
    if (writer.isComplete(shard)) progress.episodes_resumed += episodesOf(shard);
  }
  progress.episodes_done = progress.episodes_resumed;
  progress.num_frames = (progress.num_episodes - progress.episodes_resumed) * static_cast<std::uint64_t>(scene.num_steps);
  const SteadyClock::time_point start = SteadyClock::now();
  const auto report = [&] {
    progress.seconds = std::chrono::duration<double>(SteadyClock::now() - start).count();
    if (options.on_progress) options.on_progress(progress);
  };
  for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard) {
    if (writer.isComplete(shard)) continue;
    const ShardData data = run.simulate(shard * manifest.episodes_per_shard, episodesOf(shard), scene.num_steps, progress);
    if (data.columns.empty()) break;
    writer.writeShard(shard, data);
    progress.episodes_done += episodesOf(shard);
    report();
  }
  result.complete = progress.episodes_done == progress.num_episodes;
  if (result.complete) writer.finish();
  report();
  return result;
}

}  // namespace taxelsim
