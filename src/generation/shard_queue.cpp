#include "generation/shard_queue.h"

#include <algorithm>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "generation/columns.h"
#include "taxelsim/error.h"

namespace taxelsim {

ShardQueue::ShardQueue(const Manifest& manifest, const std::vector<bool>& complete, int num_frames,
                       std::function<bool(std::uint64_t)> claim)
    : complete_(complete),
      claim_(std::move(claim)),
      episodes_(manifest.episodes),
      num_episodes_(manifest.num_episodes),
      episodes_per_shard_(manifest.episodes_per_shard),
      num_frames_(static_cast<std::uint64_t>(num_frames)) {
  for (const Column& column : manifest.columns) columns_.push_back({rowBytes(column), column.per_episode});
  for (std::uint64_t shard = 0; shard < complete_.size(); ++shard) {
    if (!complete_[shard]) num_left_ += episodesOf(shard);
  }
}

std::uint64_t ShardQueue::episodesOf(std::uint64_t shard) const {
  return std::min(episodes_per_shard_, num_episodes_ - shard * episodes_per_shard_);
}

void ShardQueue::openNext() {
  for (; next_shard_ < complete_.size(); ++next_shard_) {
    if (complete_[next_shard_]) continue;
    if (!claim_ || claim_(next_shard_)) {
      open_.push_back(openShard(next_shard_));
      return;
    }
    num_left_ -= episodesOf(next_shard_);
  }
}

std::unique_ptr<ShardBuffer> ShardQueue::openShard(std::uint64_t shard) {
  const std::uint64_t num_episodes = episodesOf(shard);
  std::unique_ptr<ShardBuffer> buffer;
  if (spare_.empty()) {
    buffer = std::make_unique<ShardBuffer>();
  } else {
    buffer = std::move(spare_.back());
    spare_.pop_back();
  }
  try {
    buffer->shard = shard;
    buffer->episodes_left = num_episodes;
    buffer->data.episode_lengths.assign(num_episodes, num_frames_);
    buffer->data.columns.resize(columns_.size());
    buffer->columns.resize(columns_.size());
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const std::uint64_t rows = columns_[i].per_episode ? num_episodes : num_episodes * num_frames_;
      buffer->data.columns[i].resize(rows * columns_[i].row_bytes);
      buffer->columns[i] = buffer->data.columns[i].data();
    }
  } catch (const std::exception&) {  // std::bad_alloc or std::length_error
    throw Error(ErrorKind::kInput, "a shard of " + std::to_string(num_episodes) + " episodes with " + std::to_string(num_frames_) +
                                       " frames does not fit into memory with " + std::to_string(open_.size()) +
                                       " other open shards; reduce episodes_per_shard or the batch size");
  }
  return buffer;
}

std::optional<EpisodePlace> ShardQueue::next() {
  if (next_row_ == 0) openNext();
  if (next_shard_ >= complete_.size()) return std::nullopt;
  const std::uint64_t row = next_shard_ * episodes_per_shard_ + next_row_;
  const EpisodePlace place{episodes_.empty() ? row : episodes_[row], next_row_, open_.back().get()};
  --num_left_;
  if (++next_row_ == episodesOf(next_shard_)) {
    next_row_ = 0;
    ++next_shard_;
  }
  return place;
}

std::unique_ptr<ShardBuffer> ShardQueue::finish(const EpisodePlace& place) {
  if (--place.buffer->episodes_left > 0) return nullptr;
  const auto found = std::find_if(open_.begin(), open_.end(), [&](const auto& buffer) { return buffer.get() == place.buffer; });
  std::unique_ptr<ShardBuffer> done = std::move(*found);
  open_.erase(found);
  return done;
}

void ShardQueue::recycle(std::unique_ptr<ShardBuffer> buffer) {
  if (buffer) spare_.push_back(std::move(buffer));
}

}  // namespace taxelsim
