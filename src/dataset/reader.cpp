#include <algorithm>
#include <cstring>
#include <span>

#include "base/files.h"
#include "dataset/checksum.h"
#include "dataset/checksum_list.h"
#include "dataset/column.h"
#include "dataset/manifest.h"
#include "dataset/shard.h"
#include "dataset/shard_listing.h"
#include "dataset/verification.h"
#include "dataset/view.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"

namespace taxelsim {

using namespace dataset;

namespace {

namespace fs = std::filesystem;

// Format 1 has texts of variable length, whose lengths HDF5 1.10 does not check, and no checksums of files.
Isolation isolationOf(const Manifest& manifest, bool isolated) {
  return isolated || manifest.format_version == 1 ? Isolation::kChild : Isolation::kNone;
}

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
  const fs::file_status status = fs::status(file, error);
  if (!fs::status_known(status)) throw Error(ErrorKind::kIo, "cannot read " + file.string() + ": " + error.message());
  if (!fs::exists(status)) throw Error(ErrorKind::kInput, directory.string() + ": no data set: it has no " + kManifestName);
  return parseManifest(file, readTextFile(file, kMaxManifestBytes));
}

std::vector<ShardStatus> checkShards(const fs::path& directory, bool contents, bool isolated) {
  const Manifest manifest = readManifest(directory);
  const Isolation isolation = isolationOf(manifest, isolated);
  const std::vector<bool> on_disk = shardsOnDisk(directory, manifest);
  std::vector<ShardStatus> result(manifest.numShards());
  std::vector<std::uint64_t> shards;
  for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard) {
    result[shard].shard = shard;
    if (on_disk[shard])
      shards.push_back(shard);
    else
      result[shard].state = ShardStatus::State::kMissing;
  }
  std::vector<ShardFile> unread;
  const auto markBroken = [&](const ShardFile& one, const Error& error) {
    result[one.shard].state = ShardStatus::State::kBroken;
    result[one.shard].problem = error.what();
  };
  const auto use = [&](const VerifiedShard& verified) {
    result[verified.shard].is_vouched_for = verified.is_vouched_for;
    if (verified.is_vouched_for) return;  // its content was checked before it was listed
    const ShardFile one{directory / shardName(verified.shard), verified.shard};
    try {
      if (verified.problem) std::rethrow_exception(verified.problem);
      unread.push_back(one);
    } catch (const Error& error) {
      markBroken(one, error);
    }
  };
  if (manifest.format_version == 1) {
    for (const std::uint64_t shard : shards) use({.shard = shard, .hashed = {}, .is_vouched_for = false, .problem = nullptr});
  } else {
    verifyShards(directory, ChecksumList(directory, manifest.numShards()), shards, {.verify_all = contents}, use);
  }
  checkShardContents(unread, manifest, contents, isolation, markBroken);
  return result;
}

ViewStatus checkView(const fs::path& directory, bool isolated) {
  const Manifest manifest = readManifest(directory);
  const fs::path file = directory / kViewName;
  std::error_code error;
  if (!fs::exists(file, error)) return {.state = ViewStatus::State::kMissing, .problem = {}};
  if (manifest.format_version == 1) return {.state = ViewStatus::State::kUnverified, .problem = {}};
  try {
    viewEnds(file, manifest, isolationOf(manifest, isolated));
  } catch (const Error& problem) {
    return {.state = ViewStatus::State::kBroken, .problem = problem.what()};
  }
  return {};
}

struct DatasetReader::Impl {
  struct Shard {
    ShardFile source;
    std::uint64_t first_frame = 0, num_frames = 0;
    std::uint64_t first_episode = 0, num_episodes = 0;  // counted over the shards present
    bool is_checked = false;
  };

  Manifest manifest;
  Isolation isolation = Isolation::kNone;
  std::vector<Shard> shards;
  std::vector<std::uint64_t> episode_ends;
  std::vector<std::uint64_t> missing;

  // Ends of all episodes of the data set if the view is whole, else empty.
  std::vector<std::uint64_t> endsOfView(const fs::path& directory) const;
  // `ends`: of the shard's episodes, from its start.
  void addShard(const ShardFile& file, bool is_checked, std::span<const std::uint64_t> ends);
  // Checks shards before the first row of each is read.
  void check(std::span<Shard> parts) const;
  // Throws Error(kInput) unless the episodes of a shard end where those of the data set do.
  void compareEnds(const Shard& shard, std::span<const std::uint64_t> ends) const;
  const Column& column(const std::string& name) const;
};

std::vector<std::uint64_t> DatasetReader::Impl::endsOfView(const fs::path& directory) const {
  if (manifest.format_version == 1) return {};
  try {
    return viewEnds(directory / kViewName, manifest, isolation);
  } catch (const Error&) {
    return {};  // the shards have the same values
  }
}

void DatasetReader::Impl::addShard(const ShardFile& file, bool is_checked, std::span<const std::uint64_t> ends) {
  Shard shard{.source = file, .is_checked = is_checked};
  shard.first_frame = episode_ends.empty() ? 0 : episode_ends.back();
  shard.num_frames = ends.back();
  shard.first_episode = episode_ends.size();
  shard.num_episodes = ends.size();
  for (const std::uint64_t end : ends) episode_ends.push_back(shard.first_frame + end);
  shards.push_back(std::move(shard));
}

void DatasetReader::Impl::check(std::span<Shard> parts) const {
  std::vector<Shard*> unchecked;
  std::vector<ShardFile> files;
  for (Shard& shard : parts) {
    if (shard.is_checked) continue;
    unchecked.push_back(&shard);
    files.push_back(shard.source);
  }
  const std::vector<std::vector<std::uint64_t>> ends = checkShardFiles(files, manifest, /*contents=*/true, isolation);
  for (std::size_t k = 0; k < unchecked.size(); ++k) {
    compareEnds(*unchecked[k], ends[k]);
    unchecked[k]->is_checked = true;
  }
}

void DatasetReader::Impl::compareEnds(const Shard& shard, std::span<const std::uint64_t> ends) const {
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (shard.first_frame + ends[i] != episode_ends[shard.first_episode + i])
      throw Error(ErrorKind::kInput, shard.source.file.string() + ": its episodes have other lengths than in " + kViewName);
  }
}

const Column& DatasetReader::Impl::column(const std::string& name) const {
  const auto found = std::find_if(manifest.columns.begin(), manifest.columns.end(), [&](const Column& c) { return c.name == name; });
  if (found == manifest.columns.end()) throw Error(ErrorKind::kInput, "data set: there is no column \"" + name + "\"");
  return *found;
}

DatasetReader::DatasetReader(fs::path directory, bool allow_incomplete, bool isolated) : impl_(std::make_unique<Impl>()) {
  impl_->manifest = readManifest(directory);
  impl_->isolation = isolationOf(impl_->manifest, isolated);
  const std::vector<std::uint64_t> all_ends = impl_->endsOfView(directory);
  const std::vector<bool> on_disk = shardsOnDisk(directory, impl_->manifest);
  std::vector<ShardFile> files;
  for (std::uint64_t number = 0; number < impl_->manifest.numShards(); ++number) {
    const ShardFile one{directory / shardName(number), number};
    if (on_disk[number])
      files.push_back(one);
    else if (allow_incomplete)
      impl_->missing.push_back(number);
    else
      throw Error(ErrorKind::kInput, one.file.string() + ": the shard is missing; run generate again to write it");
  }
  if (all_ends.empty()) {
    const auto ends = checkShardFiles(files, impl_->manifest, /*contents=*/false, impl_->isolation);
    const bool are_checked = impl_->manifest.format_version > 1;
    for (std::size_t i = 0; i < files.size(); ++i) impl_->addShard(files[i], are_checked, ends[i]);
    return;
  }
  for (const ShardFile& one : files) {
    const std::uint64_t first = firstEpisode(impl_->manifest, one.shard);
    const std::uint64_t first_frame = first > 0 ? all_ends[first - 1] : 0;
    std::vector<std::uint64_t> ends;
    for (std::uint64_t i = 0; i < dataset::numEpisodes(impl_->manifest, one.shard); ++i) ends.push_back(all_ends[first + i] - first_frame);
    impl_->addShard(one, /*is_checked=*/false, ends);
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

void DatasetReader::checkShard(std::uint64_t number, bool contents) const {
  const auto shard = std::ranges::find(impl_->shards, number, [](const Impl::Shard& one) { return one.source.shard; });
  if (shard == impl_->shards.end()) throw Error(ErrorKind::kInput, shardName(number) + ": the data set has no such shard");
  if (contents && impl_->manifest.format_version > 1) compareChecksum(shard->source.file);
  impl_->compareEnds(*shard, checkShardContents({&shard->source, 1}, impl_->manifest, contents, impl_->isolation).front());
}

std::vector<std::byte> DatasetReader::read(const std::string& name, std::uint64_t first, std::uint64_t count) const {
  const Column* const column = &impl_->column(name);
  const std::uint64_t num_rows = column->per_episode ? numEpisodes() : numFrames();
  if (first > num_rows || count > num_rows - first)
    throw Error(ErrorKind::kInput, "data set: column " + name + " has " + std::to_string(num_rows) +
                                       " rows; requested: " + std::to_string(count) + " from row " + std::to_string(first));
  std::vector<std::byte> rows(rowBytes(*column) * count);  // of rows that shards on disk hold, so that the product fits
  if (count == 0) return rows;
  const auto beginOf = [&](const Impl::Shard& shard) { return column->per_episode ? shard.first_episode : shard.first_frame; };
  const auto endOf = [&](const Impl::Shard& shard) {
    return beginOf(shard) + (column->per_episode ? shard.num_episodes : shard.num_frames);
  };
  std::vector<Impl::Shard>& all = impl_->shards;
  const auto begin = std::ranges::upper_bound(all, first, {}, endOf);
  const auto end = std::ranges::lower_bound(begin, all.end(), first + count, {}, beginOf);
  std::vector<ShardRows> parts;
  for (const Impl::Shard& shard : std::span(begin, end)) {
    const std::uint64_t from = std::max(first, beginOf(shard));
    parts.push_back({.file = shard.source.file, .first = from - beginOf(shard), .count = std::min(first + count, endOf(shard)) - from});
  }
  impl_->check({begin, end});
  readShardRows(parts, *column, impl_->isolation, rows.data());
  return rows;
}

std::vector<double> DatasetReader::readAsDouble(const std::string& name, std::uint64_t first, std::uint64_t count) const {
  const std::vector<std::byte> bytes = read(name, first, count);
  switch (impl_->column(name).type) {
    case ScalarType::kUint8:
      return toDoubles<std::uint8_t>(bytes);
    case ScalarType::kUint16:
      return toDoubles<std::uint16_t>(bytes);
    case ScalarType::kInt16:
      return toDoubles<std::int16_t>(bytes);
    case ScalarType::kInt32:
      return toDoubles<std::int32_t>(bytes);
    case ScalarType::kUint64:
      return toDoubles<std::uint64_t>(bytes);
    case ScalarType::kFloat32:
      return toDoubles<float>(bytes);
    case ScalarType::kFloat64:
      return toDoubles<double>(bytes);
    case ScalarType::kText:
      break;
  }
  throw Error(ErrorKind::kInput, "data set: column " + name + " has text, not numbers");
}

std::vector<std::string> DatasetReader::readAsText(const std::string& name, std::uint64_t first, std::uint64_t count) const {
  const std::vector<std::byte> bytes = read(name, first, count);
  const Column& column = impl_->column(name);
  if (column.type != ScalarType::kText) throw Error(ErrorKind::kInput, "data set: column " + name + " has numbers, not text");
  std::vector<std::string> texts;
  for (std::size_t at = 0; at < bytes.size(); at += column.text_length) {
    const char* const text = reinterpret_cast<const char*>(bytes.data() + at);
    texts.emplace_back(text, std::find(text, text + column.text_length, '\0'));
  }
  return texts;
}

}  // namespace taxelsim
