#include "generation/shard_writer.h"

#include <chrono>
#include <utility>

#include "base/thread_priority.h"

namespace taxelsim {

ShardWriter::ShardWriter(DatasetWriter& writer, std::size_t max_waiting, int num_threads) : writer_(writer), max_waiting_(max_waiting) {
  try {
    for (int thread = 0; thread < num_threads; ++thread) threads_.emplace_back([this] { run(); });
  } catch (...) {
    stopThreads();
    throw;
  }
}

ShardWriter::~ShardWriter() {
  stopThreads();
}

void ShardWriter::run() {
  lowerThreadPriority();
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return closing_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    std::unique_ptr<ShardBuffer> buffer = std::move(waiting_.front());
    waiting_.pop_front();
    ++num_writing_;
    // After a failed write (disk full or gone) the remaining shards are dropped; the next run generates missing shards again.
    if (!error_) {
      lock.unlock();
      std::exception_ptr error;
      try {
        writer_.writeShard(buffer->shard, buffer->data);
      } catch (...) {
        error = std::current_exception();
      }
      lock.lock();
      if (error) {
        error_ = error;
      } else {
        num_episodes_written_ += buffer->data.episode_lengths.size();
      }
    }
    --num_writing_;
    written_.push_back(std::move(buffer));
    changed_.notify_all();
  }
}

void ShardWriter::submit(std::unique_ptr<ShardBuffer> buffer) {
  const auto start = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return error_ || waiting_.size() + num_writing_ <= max_waiting_; });
  seconds_waited_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (error_) std::rethrow_exception(error_);
  waiting_.push_back(std::move(buffer));
  changed_.notify_all();
}

std::unique_ptr<ShardBuffer> ShardWriter::reclaim() {
  const std::lock_guard lock(mutex_);
  if (written_.empty()) return nullptr;
  std::unique_ptr<ShardBuffer> buffer = std::move(written_.back());
  written_.pop_back();
  return buffer;
}

std::uint64_t ShardWriter::numEpisodesWritten() const {
  const std::lock_guard lock(mutex_);
  return num_episodes_written_;
}

void ShardWriter::stopThreads() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

void ShardWriter::close() {
  stopThreads();
  if (error_) std::rethrow_exception(error_);
}

}  // namespace taxelsim
