#include "workers/generate_together.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/memory.h"
#include "episodes/contact_misses.h"
#include "episodes/draw.h"
#include "generation/open_shards.h"
#include "workers/worker.h"
#include "workers/worker_count.h"
#include "workers/worker_processes.h"

namespace taxelsim::workers {
namespace {

std::uint64_t numShards(const Scene& scene) {
  return (scene.num_episodes + scene.episodes_per_shard - 1) / scene.episodes_per_shard;
}

// Adds the misses of a worker to those of all.
void add(std::vector<LoadMisses>& all, const std::vector<LoadMisses>& more) {
  all.resize(std::max(all.size(), more.size()));
  for (std::size_t object = 0; object < more.size(); ++object) {
    LoadMisses& sum = all[object];
    const LoadMisses& misses = more[object];
    sum.num_episodes += misses.num_episodes;
    if (misses.num_misses == 0) continue;
    sum.carried = sum.num_misses == 0
                      ? misses.carried
                      : std::array{std::min(sum.carried[0], misses.carried[0]), std::max(sum.carried[1], misses.carried[1])};
    sum.num_misses += misses.num_misses;
  }
}

}  // namespace

int fittingWorkers(const Scene& scene, const GenerateOptions& options, int num_processes) {
  const std::uint64_t num_shards = options.shards ? options.shards->end - options.shards->first : numShards(scene);
  int fitting =
      static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(num_processes), std::max<std::uint64_t>(num_shards, 1)));
  for (; fitting > 1; --fitting) {
    GenerateOptions share = options;
    share.batch_size = batchShare(options.batch_size, fitting);
    if (fitting * openShardBytes(scene, share) <= static_cast<double>(usableMemory())) break;
  }
  return fitting;
}

GenerateResult generateTogether(const Device& device, const Scene& scene, const std::filesystem::path& directory, GenerateOptions options,
                                int num_processes) {
  WorkerProcesses workers("its shards are made by the others");
  const std::function<void(const Progress&)> on_progress = std::exchange(options.on_progress, {});
  std::uint64_t num_left = 0;  // episodes of the shards that are missing at the start
  const auto together = [&](const Progress& own) {
    const Progress others = workers.progress();
    const std::uint64_t num_simulated = own.episodes_done - own.episodes_resumed + others.episodes_done - others.episodes_resumed;
    Progress sum = own;
    sum.num_frames = num_left * static_cast<std::uint64_t>(numFrames(scene));
    sum.frames_done = std::min(own.frames_done + others.frames_done, sum.num_frames);
    sum.episodes_resumed = own.num_episodes - num_left;
    sum.episodes_done = std::min(sum.episodes_resumed + num_simulated, own.num_episodes);
    return sum;
  };
  Progress last;
  options.on_progress = [&](const Progress& own) {
    last = own;
    if (on_progress) on_progress(together(own));
  };
  options.batch_size = batchShare(options.batch_size, num_processes);
  options.workers = {.num_processes = num_processes,
                     .start =
                         [&](std::uint64_t num_episodes) {
                           num_left = num_episodes;
                           workers.start(num_processes);
                         },
                     .join =
                         [&] {
                           workers.join(options.stop, [&] {
                             if (last.num_episodes > 0) options.on_progress(last);
                           });
                         }};
  GenerateResult result = generate(device, scene, directory, options);
  result.contact_misses.resize(1);
  for (const WorkerReport& report : workers.reports()) {
    for (const Message& message : report.messages) {
      if (message.kind == MessageKind::kLoadMisses) add(result.load_misses, message.values<LoadMisses>());
      if (message.kind != MessageKind::kContactMisses) continue;
      for (const ContactMisses& misses : message.values<ContactMisses>()) taxelsim::add(result.contact_misses[0], misses);
    }
  }
  warnOfContactMisses(scene, result.contact_misses);
  result.num_load_misses = 0;
  for (const LoadMisses& misses : result.load_misses) result.num_load_misses += misses.num_misses;
  const std::uint64_t num_on_disk = result.progress.episodes_done;
  result.progress = together(result.progress);
  result.progress.episodes_done = num_on_disk;
  return result;
}

int generateAsWorker(const Device& device, const Scene& scene, const std::filesystem::path& directory, GenerateOptions options,
                     int num_processes) {
  return runWorker([&](const Worker& worker) {
    options.batch_size = batchShare(options.batch_size, num_processes);
    options.workers.num_processes = num_processes;
    options.repair = false;  // the process that started this one has done it
    options.stop = worker.stop();
    options.on_progress = [&](const Progress& progress) { worker.report(progress); };
    if (!options.shards) options.shards = ShardRange{.first = 0, .end = numShards(scene)};
    const GenerateResult result = generate(device, scene, directory, options);
    worker.sendValues(MessageKind::kLoadMisses, std::span<const LoadMisses>(result.load_misses));
    worker.sendValues(MessageKind::kContactMisses, std::span<const ContactMisses>(result.contact_misses));
  });
}

}  // namespace taxelsim::workers
