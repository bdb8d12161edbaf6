#include "cli/shard_sample.h"

#include <algorithm>

#include "dataset/column.h"

namespace taxelsim::cli {
namespace {

// The bytes of a shard are hashed before it is read.
constexpr std::uint64_t kMaxShards = 16;
constexpr double kMaxBytes = 256 << 20;

double numBytes(const DatasetReader& reader) {
  double bytes = 0;
  for (const Column& column : reader.manifest().columns)
    bytes += static_cast<double>(dataset::rowBytes(column)) *
             static_cast<double>(column.per_episode ? reader.numEpisodes() : reader.numFrames());
  return bytes;
}

// Rows of the shards on disk, in order.
std::vector<RowRange> episodesOf(const DatasetReader& reader) {
  const Manifest& manifest = reader.manifest();
  std::vector<RowRange> episodes;
  auto missing = reader.missingShards().begin();
  std::uint64_t first = 0;
  for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard) {
    if (missing != reader.missingShards().end() && *missing == shard) {
      ++missing;
      continue;
    }
    const std::uint64_t count = std::min(manifest.episodes_per_shard, manifest.num_episodes - shard * manifest.episodes_per_shard);
    episodes.push_back({first, count});
    first += count;
  }
  return episodes;
}

// Extends the last range if `rows` follow it.
void append(std::vector<RowRange>& ranges, const RowRange& rows) {
  if (!ranges.empty() && ranges.back().first + ranges.back().count == rows.first)
    ranges.back().count += rows.count;
  else
    ranges.push_back(rows);
}

}  // namespace

ShardSample sampleShards(const DatasetReader& reader, bool all) {
  const std::vector<RowRange> shards = episodesOf(reader);
  const double bytes = numBytes(reader);
  std::uint64_t num_read = shards.size();
  if (!all && num_read > 0) {
    const double fitting = kMaxBytes / std::max(1.0, bytes) * static_cast<double>(num_read);
    num_read = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(std::min(fitting, 1e9)), 1, std::min(kMaxShards, num_read));
  }
  ShardSample sample{.num_shards = num_read, .frames = {}, .episodes = {}};
  for (std::uint64_t i = 0; i < num_read; ++i) {
    // From the first to the last shard.
    const RowRange& episodes = shards[num_read > 1 ? i * (shards.size() - 1) / (num_read - 1) : 0];
    const std::vector<std::uint64_t>& ends = reader.episodeEnds();
    const std::uint64_t first_frame = episodes.first > 0 ? ends[episodes.first - 1] : 0;
    append(sample.episodes, episodes);
    append(sample.frames, {first_frame, ends[episodes.first + episodes.count - 1] - first_frame});
  }
  return sample;
}

}  // namespace taxelsim::cli
