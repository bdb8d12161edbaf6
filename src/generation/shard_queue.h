// Work queue of a run: hands out the episodes of incomplete shards in order, with the memory that their rows are written to.
//
// A shard is buffered as whole columns. All episodes have the same number of frames, so the place of each row is known in advance, and
// episodes may end in any order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "taxelsim/dataset.h"

namespace taxelsim {

// An unfinished shard in memory.
struct ShardBuffer {
  std::uint64_t shard = 0;
  std::uint64_t episodes_left = 0;  // not finished yet
  ShardData data;
  std::vector<std::byte*> columns;  // first byte of each column of `data`
};

// Destination of the rows of an episode. Valid until finish() returns its shard.
struct EpisodePlace {
  std::uint64_t episode = 0;  // its number
  std::uint64_t row = 0;      // episode row in the shard; its frame rows start at row * num_frames
  ShardBuffer* buffer = nullptr;
};

// Not thread-safe.
class ShardQueue {
 public:
  // complete (num_shards): shards to skip. num_frames: per episode. claim: called before the first episode of a shard is handed out; false
  // to skip the shard. Default: none is skipped.
  ShardQueue(const Manifest& manifest, const std::vector<bool>& complete, int num_frames, std::function<bool(std::uint64_t)> claim = {});

  std::uint64_t numEpisodesLeft() const { return num_left_; }  // not handed out yet

  // The next episode; empty if none are left. The first episode of a shard allocates its buffer; throws Error(kInput) if that fails.
  std::optional<EpisodePlace> next();

  // Marks an episode as finished: all its rows are written. Returns the shard if that was its last episode, else null.
  std::unique_ptr<ShardBuffer> finish(const EpisodePlace& place);

  // Returns a written buffer for reuse. Null is ignored.
  void recycle(std::unique_ptr<ShardBuffer> buffer);

  std::size_t numOpen() const { return open_.size(); }  // shards in memory that are not finished

 private:
  struct ColumnLayout {
    std::size_t row_bytes;
    bool per_episode;
  };

  std::uint64_t episodesOf(std::uint64_t shard) const;
  std::unique_ptr<ShardBuffer> openShard(std::uint64_t shard);
  // Moves on to the next shard that is neither complete nor claimed by others.
  void openNext();

  std::vector<ColumnLayout> columns_;
  std::vector<bool> complete_;
  std::function<bool(std::uint64_t)> claim_;
  std::vector<std::uint64_t> episodes_;  // numbers by row of the data set; empty if they are equal
  std::uint64_t num_episodes_;
  std::uint64_t episodes_per_shard_;
  std::uint64_t num_frames_;
  std::uint64_t num_left_ = 0;
  std::uint64_t next_shard_ = 0;  // shard of the next episode
  std::uint64_t next_row_ = 0;    // its row in that shard
  std::vector<std::unique_ptr<ShardBuffer>> open_;
  std::vector<std::unique_ptr<ShardBuffer>> spare_;
};

}  // namespace taxelsim
