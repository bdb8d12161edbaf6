#include "generation/shard_run.h"

#include <algorithm>
#include <thread>

namespace taxelsim {
namespace {

constexpr auto kProgressPeriod = std::chrono::milliseconds(250);

}  // namespace

DatasetWriterOptions writerOptions(const GenerateOptions& options) {
  return {.repair = options.repair, .shards = options.shards, .on_verify = options.on_verify, .stop = options.stop};
}

GenerateResult unverifiedResult(const Manifest& manifest) {
  GenerateResult result;
  result.progress.num_episodes = manifest.num_episodes;
  result.verified = false;
  return result;
}

ShardRun::ShardRun(const GenerateOptions& options, DatasetWriter& writer, const Manifest& manifest, int num_frames)
    : options_(options), writer_(writer), manifest_(manifest), num_frames_(static_cast<std::uint64_t>(num_frames)) {
  const ShardRange range = options.shards.value_or(ShardRange{.first = 0, .end = manifest.numShards()});
  Progress& progress = result_.progress;
  complete_.resize(manifest.numShards());
  for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard) {
    complete_[shard] = !range.contains(shard);
    if (complete_[shard]) continue;
    progress.num_episodes += episodesOf(shard);
    if (writer.isComplete(shard)) addFound(shard);
  }
  progress.num_frames = (progress.num_episodes - progress.episodes_resumed) * num_frames_;
}

std::uint64_t ShardRun::episodesOf(std::uint64_t shard) const {
  return std::min(manifest_.episodes_per_shard, manifest_.num_episodes - shard * manifest_.episodes_per_shard);
}

bool ShardRun::isComplete() const {
  return std::find(complete_.begin(), complete_.end(), false) == complete_.end();
}

// Counts a shard that this run did not make.
void ShardRun::addFound(std::uint64_t shard) {
  complete_[shard] = true;
  result_.progress.episodes_resumed += episodesOf(shard);
  result_.progress.episodes_done += episodesOf(shard);
}

// Looks for the shards that others have written.
void ShardRun::findShards() {
  for (std::uint64_t shard = 0; shard < complete_.size(); ++shard) {
    if (complete_[shard]) continue;
    if (writer_.isComplete(shard)) {
      complete_[shard] = true;
    } else if (writer_.isOnDisk(shard)) {
      addFound(shard);
      result_.progress.num_frames -= episodesOf(shard) * num_frames_;
    }
  }
}

bool ShardRun::claimsAny() {
  for (std::uint64_t shard = 0; shard < complete_.size(); ++shard) {
    if (!complete_[shard] && writer_.claim(shard)) return true;
  }
  return false;
}

void ShardRun::restartClock() {
  if (episodes_written_ == 0) start_ = last_report_ = SteadyClock::now();
}

void ShardRun::report() {
  const SteadyClock::time_point now = SteadyClock::now();
  result_.progress.seconds = std::chrono::duration<double>(now - start_).count();
  if (!options_.on_progress || now - last_report_ < kProgressPeriod) return;
  last_report_ = now;
  options_.on_progress(result_.progress);
}

void ShardRun::addWritten(std::uint64_t num_episodes) {
  Progress& progress = result_.progress;
  episodes_written_ += num_episodes;
  progress.episodes_done = progress.episodes_resumed + episodes_written_;
  progress.seconds = std::chrono::duration<double>(SteadyClock::now() - start_).count();
}

void ShardRun::simulateAll(const std::function<void()>& simulate) {
  while (!isComplete() && !isStopped()) {
    if (claimsAny()) {
      simulate();
    } else {
      std::this_thread::sleep_for(kProgressPeriod);
      report();
    }
    findShards();
  }
}

GenerateResult ShardRun::end() {
  result_.complete = isComplete();
  if (result_.complete && !options_.shards) writer_.finish();
  if (options_.on_progress) options_.on_progress(result_.progress);
  return result_;
}

}  // namespace taxelsim
