// Writes finished shards on a thread of its own, so that the disk and the device work at once.
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

class ShardWriter {
 public:
  // max_waiting: shards that may wait for the disk, >= 1. `writer` must outlive this and is used by its thread alone from now on until
  // close() has returned.
  ShardWriter(DatasetWriter& writer, std::size_t max_waiting);
  // Writes what waits, whatever becomes of it.
  ~ShardWriter();
  ShardWriter(const ShardWriter&) = delete;
  ShardWriter& operator=(const ShardWriter&) = delete;

  // Hands a shard over; waits while max_waiting are there already. Throws what a write before threw.
  void submit(std::unique_ptr<ShardBuffer> buffer);

  // A buffer that has been written, or null. Does not wait.
  std::unique_ptr<ShardBuffer> reclaim();

  // Waits until all is written and ends the thread. Throws what a write threw.
  void close();

  std::uint64_t numEpisodesWritten() const;

  // That submit() has waited so far; of the thread that calls it.
  double secondsWaited() const { return seconds_waited_; }

 private:
  void run();
  void stopThread();

  DatasetWriter& writer_;
  const std::size_t max_waiting_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::unique_ptr<ShardBuffer>> waiting_;
  std::vector<std::unique_ptr<ShardBuffer>> written_;
  std::uint64_t num_episodes_written_ = 0;
  double seconds_waited_ = 0;
  std::exception_ptr error_;
  bool closing_ = false;
  std::thread thread_;
};

}  // namespace taxelsim
