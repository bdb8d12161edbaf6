// Writes complete shards in background threads, so that disk and device work concurrently: all shards of a batch end at the same time.
// Bounded queue: submit() blocks when it is full.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "generation/shard_queue.h"

namespace taxelsim {

// submit(), reclaim() and close() must be called by one thread; numEpisodesWritten() by any.
class ShardWriter {
 public:
  // max_waiting (>= 1): capacity of the queue; shards that are being written, except one, count. num_threads: >= 1. `writer` must outlive
  // this, and others must not write shards with it until close() has returned. Throws std::system_error if a thread cannot be created.
  ShardWriter(DatasetWriter& writer, std::size_t max_waiting, int num_threads = 1);
  // Writes the queued shards; errors are ignored.
  ~ShardWriter();
  ShardWriter(const ShardWriter&) = delete;
  ShardWriter& operator=(const ShardWriter&) = delete;

  // Queues a shard; blocks while the queue is full. Rethrows the error of an earlier write.
  void submit(std::unique_ptr<ShardBuffer> buffer);

  // A written buffer, for reuse; null if there is none. Does not block.
  std::unique_ptr<ShardBuffer> reclaim();

  // Waits until all queued shards are written and ends the threads. Rethrows the error of a write.
  void close();

  std::uint64_t numEpisodesWritten() const;

  // Time (s) that submit() has blocked so far.
  double secondsWaited() const { return seconds_waited_; }

 private:
  void run();
  void stopThreads();

  DatasetWriter& writer_;
  const std::size_t max_waiting_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::unique_ptr<ShardBuffer>> waiting_;
  std::vector<std::unique_ptr<ShardBuffer>> written_;
  std::size_t num_writing_ = 0;
  std::uint64_t num_episodes_written_ = 0;
  double seconds_waited_ = 0;
  std::exception_ptr error_;
  bool closing_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace taxelsim
