#include "cli/generate_processes.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "cli/activity.h"
#include "cli/interrupt.h"
#include "cli/processes.h"
#include "dataset/manifest.h"
#include "episodes/contact_misses.h"
#include "figures/text.h"

namespace taxelsim::cli {
namespace {

// Result of a process without the misses, which follow it in the bytes: by object, then by finger.
struct PartResult {
  Progress progress;
  bool complete, verified;
};

std::size_t numFingers(const Scene& scene) {
  return scene.grasp ? scene.grasp->fingers.size() : 1;
}

std::string bytesOf(const Scene& scene, GenerateResult result) {
  result.load_misses.resize(scene.objects.size());
  result.contact_misses.resize(numFingers(scene));
  const PartResult part{.progress = result.progress, .complete = result.complete, .verified = result.verified};
  std::string bytes;
  putValues(bytes, std::span(&part, 1));
  putValues<LoadMisses>(bytes, result.load_misses);
  putValues<ContactMisses>(bytes, result.contact_misses);
  return bytes;
}

void addMisses(LoadMisses& sum, const LoadMisses& misses) {
  sum.num_episodes += misses.num_episodes;
  if (misses.num_misses == 0) return;
  const auto [least, most] = sum.num_misses == 0 ? misses.carried : sum.carried;
  sum.carried = {std::min(least, misses.carried[0]), std::max(most, misses.carried[1])};
  sum.num_misses += misses.num_misses;
}

void addPart(const Scene& scene, GenerateResult& sum, std::string_view bytes) {
  const PartResult part = takeValues<PartResult>(bytes, 1).front();
  sum.complete = sum.complete && part.complete;
  sum.verified = sum.verified && part.verified;
  add(sum.progress, part.progress);
  for (std::size_t object = 0; const LoadMisses& misses : takeValues<LoadMisses>(bytes, scene.objects.size()))
    addMisses(sum.load_misses[object++], misses);
  for (std::size_t finger = 0; const ContactMisses& misses : takeValues<ContactMisses>(bytes, numFingers(scene)))
    add(sum.contact_misses[finger++], misses);
}

bool holdsFewerEpisodes(const std::filesystem::path& directory, const Scene& scene) {
  return std::filesystem::exists(directory / dataset::kManifestName) && readManifest(directory).num_episodes < scene.num_episodes;
}

}  // namespace

void logRun(const Scene& scene, const DeviceInfo& device) {
  spdlog::info("{}: {} episodes on {} ({})", sceneTitle(scene), figures::countText(scene.num_episodes), device.name, device.driver);
}

GenerateResult generateInProcesses(const SceneOptions& scene_options, const Scene& scene, const std::filesystem::path& directory,
                                   const GenerateOptions& options, int num_processes) {
  const std::uint64_t num_shards = (scene.num_episodes + scene.episodes_per_shard - 1) / scene.episodes_per_shard;
  const ShardRange all = options.shards.value_or(ShardRange{.first = 0, .end = num_shards});
  // Processes that share a directory cannot extend its data set, and would all warn of damaged shards: one of them comes before the others.
  if (options.repair || (!options.shards && holdsFewerEpisodes(directory, scene)))
    forkProcesses(1, [&](const Process& process) {
      std::atomic<bool> stop{false};
      GenerateOptions own = options;
      own.stop = &stop;
      own.on_verify = [&](std::uint64_t num_verified, std::uint64_t num_found) { stop = num_verified == num_found || process.stop; };
      generate(openDevice(scene_options), scene, directory, own);
      return std::string();
    });
  GenerateResult sum;
  sum.verified = sum.complete = !stopOnSignals();
  if (!sum.verified) return sum;
  sum.load_misses.resize(scene.objects.size());
  sum.contact_misses.resize(numFingers(scene));
  const std::vector<std::string> results = forkProcesses(num_processes, [&](const Process& process) {
    const auto [first, end] =
        partOfShards(all.end - all.first, static_cast<std::uint64_t>(process.number) + 1, static_cast<std::uint64_t>(num_processes));
    GenerateOptions own = options;
    own.shards = ShardRange{.first = all.first + first, .end = all.first + end};
    own.num_processes = num_processes;
    own.batch_size = batchShare(options.batch_size, num_processes);
    own.stop = &process.stop;
    own.on_progress = process.report;
    const Device device = openDevice(scene_options);
    if (process.number == 0) logRun(scene, device.info());
    const GenerateResult result = generate(device, scene, directory, own);
    if (result.verified) process.report(result.progress);
    return bytesOf(scene, result);
  });
  for (const std::string& bytes : results) addPart(scene, sum, bytes);
  warnOfContactMisses(scene, sum.contact_misses);
  if (!sum.complete || options.shards) return sum;
  Activity activity("verifying");
  sum.verified = finishDataset(directory, {.stop = &stopOnSignals()});
  return sum;
}

}  // namespace taxelsim::cli
