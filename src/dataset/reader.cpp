#include <algorithm>
#include <cstring>
#include <span>

#include "base/files.h"
#include "dataset/manifest.h"
#include "dataset/shard.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"

namespace taxelsim {

using namespace dataset;

namespace {

namespace fs = std::filesystem;

template <typename T>
std::vector<double> toDoubles(std::span<const std::byte> bytes) {
  std::vector<double> values(bytes.size() / sizeof(T));
  for (std::size_t i = 0; i < values.size(); ++i) {
    T value;
    std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
    values[i] = static_cast<double>(value);
  }
  return values;
}

}  // namespace

Manifest readManifest(const fs::path& directory) {
  std::error_code error;
  const fs::path file = directory / kManifestName;
  if (!fs::exists(file, error)) throw Error(ErrorKind::kInput, directory.string() + ": no data set: it has no " + kManifestName);
  return parseManifest(file, readTextFile(file));
}

std::vector<ShardStatus> checkShards(const fs::path& directory, bool contents) {
  const Manifest manifest = readManifest(directory);
  std::vector<ShardStatus> result;
  for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard) {
    ShardStatus status{.shard = shard, .state = ShardStatus::State::kWhole, .problem = {}};
    const fs::path file = directory / shardName(shard);
    try {
      std::error_code error;
      if (fs::exists(file, error))
        checkShard(file, manifest, shard, contents);
      else
        status.state = ShardStatus::State::kMissing;
    } catch (const Error& error) {
      status.state = ShardStatus::State::kBroken;
      status.problem = error.what();
    }
    result.push_back(std::move(status));
  }
  return result;
}

struct DatasetReader::Impl {
  struct Shard {
    fs::path file;
    std::uint64_t first_frame = 0, num_frames = 0;
    std::uint64_t first_episode = 0, num_episodes = 0;  // counted over the shards present
  };

  Manifest manifest;
  std::vector<Shard> shards;
  std::vector<std::uint64_t> episode_ends;
  std::vector<std::uint64_t> missing;
};

DatasetReader::DatasetReader(fs::path directory, bool allow_incomplete) : impl_(std::make_unique<Impl>()) {
  impl_->manifest = readManifest(directory);
  std::uint64_t num_frames = 0;
  for (std::uint64_t shard = 0; shard < impl_->manifest.numShards(); ++shard) {
    const fs::path file = directory / shardName(shard);
    std::error_code error;
    if (!fs::exists(file, error)) {
      if (!allow_incomplete) throw Error(ErrorKind::kInput, file.string() + ": this shard is missing: the data set is not complete");
      impl_->missing.push_back(shard);
      continue;
    }
    const std::vector<std::uint64_t> ends = checkShard(file, impl_->manifest, shard, /*contents=*/false);
    impl_->shards.push_back({file, num_frames, ends.back(), impl_->episode_ends.size(), ends.size()});
    for (const std::uint64_t end : ends) impl_->episode_ends.push_back(num_frames + end);
    num_frames += ends.back();
  }
}

DatasetReader::~DatasetReader() = default;
DatasetReader::DatasetReader(DatasetReader&&) noexcept = default;

const Manifest& DatasetReader::manifest() const {
  return impl_->manifest;
}
std::uint64_t DatasetReader::numFrames() const {
  return impl_->episode_ends.empty() ? 0 : impl_->episode_ends.back();
}
std::uint64_t DatasetReader::numEpisodes() const {
  return impl_->episode_ends.size();
}
const std::vector<std::uint64_t>& DatasetReader::episodeEnds() const {
  return impl_->episode_ends;
}
const std::vector<std::uint64_t>& DatasetReader::missingShards() const {
  return impl_->missing;
}

std::vector<std::byte> DatasetReader::read(const std::string& name, std::uint64_t first, std::uint64_t count) const {
  const auto& columns = impl_->manifest.columns;
  const auto column = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; });
  if (column == columns.end()) throw Error(ErrorKind::kInput, "data set: there is no column \"" + name + "\"");
  const std::uint64_t num_rows = column->per_episode ? numEpisodes() : numFrames();
  if (first > num_rows || count > num_rows - first)
    throw Error(ErrorKind::kInput, "data set: column " + name + " has " + std::to_string(num_rows) +
                                       " rows; requested: " + std::to_string(count) + " from row " + std::to_string(first));
  const std::size_t row_bytes = rowBytes(*column);
  std::vector<std::byte> rows(row_bytes * count);
  for (const Impl::Shard& shard : impl_->shards) {
    const std::uint64_t begin = column->per_episode ? shard.first_episode : shard.first_frame;
    const std::uint64_t end = begin + (column->per_episode ? shard.num_episodes : shard.num_frames);
    const std::uint64_t from = std::max(first, begin);
    const std::uint64_t to = std::min(first + count, end);
    if (from < to) readShardRows(shard.file, *column, from - begin, to - from, rows.data() + (from - first) * row_bytes);
  }
  return rows;
}

std::vector<double> DatasetReader::readAsDouble(const std::string& name, std::uint64_t first, std::uint64_t count) const {
  const std::vector<std::byte> bytes = read(name, first, count);
  const auto& columns = impl_->manifest.columns;
  const auto column = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; });
  switch (column->type) {
    case ScalarType::kUint16:
      return toDoubles<std::uint16_t>(bytes);
    case ScalarType::kInt32:
      return toDoubles<std::int32_t>(bytes);
    case ScalarType::kUint64:
      return toDoubles<std::uint64_t>(bytes);
    case ScalarType::kFloat32:
      return toDoubles<float>(bytes);
    case ScalarType::kFloat64:
      break;
  }
  return toDoubles<double>(bytes);
}

}  // namespace taxelsim
