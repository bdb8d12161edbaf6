// Which episode is simulated next, and the memory its rows go to: shards under way, opened in order, whole columns at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "taxelsim/dataset.h"

namespace taxelsim {

// One shard under way. Every episode has the same number of frames, so each row's place is known from the start.
struct ShardBuffer {
  std::uint64_t shard = 0;
  std::uint64_t episodes_left = 0;  // to be simulated
  ShardData data;
  std::vector<std::byte*> columns;  // first byte of each of data's columns
};

// Where the rows of one episode go. Valid until its shard is taken.
struct EpisodePlace {
  std::uint64_t episode = 0;
  std::uint64_t row = 0;  // of the episode in its shard; its frames begin at row * num_frames
  ShardBuffer* buffer = nullptr;
};

class ShardQueue {
 public:
  // complete (num_shards): shards to leave out.
  ShardQueue(const Manifest& manifest, const std::vector<bool>& complete, int num_frames);

  std::uint64_t numEpisodesLeft() const { return num_left_; }  // not handed out yet

  // The next episode, in order; nothing when all are handed out. Opens a shard's buffer with its first one; throws Error(kInput) when
  // memory cannot hold it.
  std::optional<EpisodePlace> next();

  // Says that all rows of an episode are written. Gives back the shard when that was its last one, else null.
  std::unique_ptr<ShardBuffer> finish(const EpisodePlace& place);

  // Takes the memory of a buffer that is written, for the shards to come. Null is ignored.
  void recycle(std::unique_ptr<ShardBuffer> buffer);

  std::size_t numOpen() const { return open_.size(); }

 private:
  struct Column {
    std::size_t row_bytes;
    bool per_episode;
  };

  std::uint64_t episodesOf(std::uint64_t shard) const;
  std::unique_ptr<ShardBuffer> openShard(std::uint64_t shard);
  void skipComplete();

  std::vector<Column> columns_;
  std::vector<bool> complete_;
  std::uint64_t num_episodes_;
  std::uint64_t episodes_per_shard_;
  std::uint64_t num_frames_;
  std::uint64_t num_left_ = 0;
  std::uint64_t next_shard_ = 0;  // the shard that the next episode belongs to
  std::uint64_t next_row_ = 0;
  std::vector<std::unique_ptr<ShardBuffer>> open_;
  std::vector<std::unique_ptr<ShardBuffer>> spare_;
};

}  // namespace taxelsim
