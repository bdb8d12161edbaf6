#include "generation/generate_grasp.h"

#include <algorithm>
#include <vector>

#include "base/sha256.h"
#include "episodes/contact_misses.h"
#include "episodes/grasp_player.h"
#include "generation/grasp_columns.h"
#include "generation/shard_run.h"

namespace taxelsim {
namespace {

constexpr int kProbeFrames = 2;  // the initial contact and one that depends on the frame before

// Moves nothing: the frames of the probe do not depend on the policy of the caller.
const std::optional<Policy>& restingPolicy() {
  static const std::optional<Policy> policy{
      {.name = "rest", .act_grasp = [](const GraspPolicyInput&, std::span<double> velocities) { std::ranges::fill(velocities, 0.0); }}};
  return policy;
}

class GraspRun {
 public:
  GraspRun(const Device& device, const Scene& scene, const Manifest& manifest, const GenerateOptions& options)
      : manifest_(manifest),
        options_(options),
        recorder_(scene),
        player_(scene, options.policy),
        batch_(
            device, scene, player_.outputs(outputsOf(scene)),
            static_cast<int>(std::min({static_cast<std::uint64_t>(options.batch_size), manifest.num_episodes, scene.episodes_per_shard})),
            player_.joints()) {}

  GraspPlayer& player() { return player_; }

  // `count` episodes of the data set from the `first` one on as a shard, moved by `player`. Empty columns after a stop. Adds to the
  // progress and the misses of `result`.
  ShardData simulate(GraspPlayer& player, std::uint64_t first, std::uint64_t count, int num_frames, GenerateResult& result);

 private:
  bool isStopped() const { return options_.stop != nullptr && *options_.stop; }
  void simulateBatch(GraspPlayer& player, std::uint64_t first, int count, std::uint64_t first_row, int num_frames,
                     std::span<std::byte* const> columns, GenerateResult& result);

  const Manifest& manifest_;
  const GenerateOptions& options_;
  GraspRecorder recorder_;
  GraspPlayer player_;
  GraspBatch batch_;
};

ShardData GraspRun::simulate(GraspPlayer& player, std::uint64_t first, std::uint64_t count, int num_frames, GenerateResult& result) {
  ShardData data{.episode_lengths = std::vector<std::uint64_t>(count, static_cast<std::uint64_t>(num_frames)), .columns = {}};
  std::vector<std::byte*> columns;
  for (const Column& column : manifest_.columns) {
    const std::uint64_t num_rows = column.per_episode ? count : count * static_cast<std::uint64_t>(num_frames);
    columns.push_back(data.columns.emplace_back(num_rows * rowBytes(column)).data());
  }
  for (std::uint64_t row = 0; row < count && !isStopped();) {
    const int size = static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(batch_.numInstances()), count - row));
    simulateBatch(player, first + row, size, row, num_frames, columns, result);
    row += static_cast<std::uint64_t>(size);
  }
  if (isStopped()) data.columns.clear();
  return data;
}

void GraspRun::simulateBatch(GraspPlayer& player, std::uint64_t first, int count, std::uint64_t first_row, int num_frames,
                             std::span<std::byte* const> columns, GenerateResult& result) {
  std::vector<std::uint64_t> episodes(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < episodes.size(); ++i) episodes[i] = manifest_.episodes.empty() ? first + i : manifest_.episodes[first + i];
  batch_.begin(episodes);
  recorder_.recordEpisodes(batch_, episodes, columns, first_row);
  std::vector<std::uint64_t> rows(static_cast<std::size_t>(count));
  for (int frame = 0; frame < num_frames && !isStopped(); ++frame) {
    player.step(batch_, count);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i] = (first_row + i) * static_cast<std::uint64_t>(num_frames) + static_cast<std::uint64_t>(frame);
    }
    recorder_.recordFrames(batch_, count, columns, rows);
    result.progress.frames_done += static_cast<std::uint64_t>(count);
  }
  if (!isStopped()) batch_.addMisses(count, result.contact_misses);
}

std::string probeOf(GraspRun& run, const Scene& scene, bool has_policy) {
  GenerateResult unused;
  Sha256 digest;
  GraspPlayer resting(scene, restingPolicy());
  const ShardData data = run.simulate(has_policy ? resting : run.player(), 0, 1, kProbeFrames, unused);
  for (const std::vector<std::byte>& column : data.columns) digest.add(column);
  return digest.finish();
}

}  // namespace

GenerateResult generateGrasp(const Device& device, const Scene& scene, const std::filesystem::path& directory, Manifest manifest,
                             const GenerateOptions& options) {
  GraspRun grasps(device, scene, manifest, options);
  manifest.probe_sha256 = probeOf(grasps, scene, options.policy.has_value());
  if (options.stop != nullptr && *options.stop) return unverifiedResult(manifest);  // the probe is incomplete
  DatasetWriter writer(directory, manifest, writerOptions(options));
  if (!writer.isVerified()) return unverifiedResult(manifest);
  ShardRun run(options, writer, manifest, scene.num_steps);
  run.restartClock();
  run.result().contact_misses.resize(scene.grasp->fingers.size());
  run.simulateAll([&] {
    for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard) {
      if (run.complete()[shard] || !writer.claim(shard)) continue;
      const ShardData data =
          grasps.simulate(grasps.player(), shard * manifest.episodes_per_shard, run.episodesOf(shard), scene.num_steps, run.result());
      if (data.columns.empty()) return;
      writer.writeShard(shard, data);
      run.addWritten(run.episodesOf(shard));
      if (options.on_progress) options.on_progress(run.result().progress);
    }
  });
  GenerateResult result = run.end();
  if (options.num_processes == 1 && !options.policy) warnOfContactMisses(scene, result.contact_misses);
  return result;
}

}  // namespace taxelsim
