// The shards of one generate() call: which are left, which this process may make, and the progress. Not thread-safe.
#pragma once

#include <chrono>
#include <functional>
#include <vector>

#include "taxelsim/generate.h"

namespace taxelsim {

// How a run writes its directory.
DatasetWriterOptions writerOptions(const GenerateOptions& options);
// Result of a run that was stopped while it verified the shards on disk.
GenerateResult unverifiedResult(const Manifest& manifest);

class ShardRun {
 public:
  // num_frames: per episode. All references must outlive this.
  ShardRun(const GenerateOptions& options, DatasetWriter& writer, const Manifest& manifest, int num_frames);

  // Calls `simulate`, which claims and writes shards, until all requested ones are on disk or the run is stopped. Other processes hold the
  // claims of the shards that are left after a call. Those of a lost process are free in a later one.
  void simulateAll(const std::function<void()>& simulate);

  bool isStopped() const { return options_.stop != nullptr && *options_.stop; }
  const std::vector<bool>& complete() const { return complete_; }  // (num_shards), true for those that are not requested
  std::uint64_t episodesOf(std::uint64_t shard) const;
  GenerateResult& result() { return result_; }

  // Starts the clock again if no episode has been written: the kernels were compiled until now.
  void restartClock();
  // Calls GenerateOptions::on_progress if it is due.
  void report();
  // Counts episodes that are on disk, after a call of `simulate`.
  void addWritten(std::uint64_t num_episodes);
  // Completes the data set if all shards are on disk and this process has the directory to itself.
  GenerateResult end();

 private:
  using SteadyClock = std::chrono::steady_clock;

  bool isComplete() const;
  void addFound(std::uint64_t shard);
  void findShards();
  bool claimsAny();

  const GenerateOptions& options_;
  DatasetWriter& writer_;
  const Manifest& manifest_;
  std::uint64_t num_frames_;
  std::vector<bool> complete_;
  std::uint64_t episodes_written_ = 0;
  GenerateResult result_;
  SteadyClock::time_point start_ = SteadyClock::now(), last_report_ = start_;
};

}  // namespace taxelsim
