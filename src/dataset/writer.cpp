#include <algorithm>
#include <cassert>
#include <optional>
#include <span>
#include <system_error>
#include <thread>

#include "base/files.h"
#include "base/log.h"
#include "base/sha256.h"
#include "dataset/checksum.h"
#include "dataset/compressor.h"
#include "dataset/directory_lock.h"
#include "dataset/manifest.h"
#include "dataset/shard.h"
#include "dataset/shard_listing.h"
#include "dataset/view.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"

namespace taxelsim {

using namespace dataset;

namespace {

namespace fs = std::filesystem;

void prepareDirectory(const fs::path& directory) {
  if (fs::exists(directory) && !fs::is_directory(directory)) throw Error(ErrorKind::kInput, directory.string() + ": is not a directory");
  createDirectories(directory);
  if (fs::exists(directory / kManifestName)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
    const std::string name = entry.path().filename().string();
    if (name != kLockName && !isTemporaryName(name))
      throw Error(ErrorKind::kInput,
                  directory.string() + ": is not empty and has no data set (it contains " + name + "): choose another directory");
  }
}

void removeTemporaryFiles(const fs::path& directory) {
  std::vector<fs::path> leftovers;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory))
    if (isTemporaryName(entry.path().filename().string())) leftovers.push_back(entry.path());
  for (const fs::path& file : leftovers) removeFile(file);
}

}  // namespace

struct DatasetWriter::Impl {
  fs::path directory;
  Manifest manifest;
  std::optional<DirectoryLock> lock;
  std::optional<Compressor> compressor;                // if the data set is compressed
  std::vector<std::vector<std::uint64_t>> shard_ends;  // (num_shards), empty if the shard is missing
  bool is_verified = false;

  fs::path shardFile(std::uint64_t shard) const { return directory / shardName(shard); }

  void writeManifestFile() {
    const std::string text = writeManifest(manifest);
    if (text.size() > kMaxManifestBytes)
      throw Error(ErrorKind::kInput, "data set: its manifest would have " + std::to_string(text.size()) + " bytes, at most " +
                                         std::to_string(kMaxManifestBytes) + " allowed");
    writeFileAtomically(directory / kManifestName, std::as_bytes(std::span(text)));
  }

  // Continues an existing data set, possibly with more episodes. The last shard of a shorter data set may be partly filled; it would have
  // to grow, so it must not exist yet.
  void resume() {
    const fs::path file = directory / kManifestName;
    const Manifest found = parseManifest(file, readTextFile(file, kMaxManifestBytes));
    checkSame(directory, found, manifest);
    if (found.num_episodes == manifest.num_episodes) return;
    if (manifest.num_episodes < found.num_episodes)
      throw Error(ErrorKind::kInput, directory.string() + ": holds a data set of " + std::to_string(found.num_episodes) + " episodes, " +
                                         std::to_string(manifest.num_episodes) + " requested: it can grow but not shrink");
    const std::uint64_t last = found.numShards() - 1;
    if (numEpisodes(found, last) < numEpisodes(manifest, last) && fs::exists(shardFile(last)))
      throw Error(ErrorKind::kInput, directory.string() + ": cannot be extended from " + std::to_string(found.num_episodes) + " to " +
                                         std::to_string(manifest.num_episodes) + " episodes: " + shardName(last) +
                                         " is complete and would change (" + std::to_string(manifest.episodes_per_shard) +
                                         " episodes per shard); remove it to generate it again");
    removeWithChecksum(directory / kViewName);
    writeManifestFile();
  }

  // Compares every shard on disk with its checksum and the manifest.
  void verify(const DatasetWriterOptions& options) {
    shard_ends.resize(manifest.numShards());
    const std::vector<bool> on_disk = shardsOnDisk(directory, manifest);
    const auto num_shards = static_cast<std::uint64_t>(std::count(on_disk.begin(), on_disk.end(), true));
    std::uint64_t num_verified = 0;
    for (std::uint64_t shard = 0; shard < on_disk.size(); ++shard) {
      if (!on_disk[shard]) continue;
      if (options.on_verify) options.on_verify(num_verified++, num_shards);
      try {
        shard_ends[shard] = checkShard(shardFile(shard), manifest, shard, /*contents=*/true, Isolation::kNone, options.stop);
      } catch (const Stopped&) {
        return;
      } catch (const Error& problem) {
        if (!options.repair || problem.kind() != ErrorKind::kInput) throw;
        logWarning(problem.what() + std::string("; the shard is removed and made again"));
        removeWithChecksum(directory / kViewName);  // it would show zeros in place of the shard
        removeWithChecksum(shardFile(shard));
      }
    }
    if (options.on_verify) options.on_verify(num_shards, num_shards);
    is_verified = true;
  }
};

DatasetWriter::DatasetWriter(fs::path directory, Manifest manifest, const DatasetWriterOptions& options) : impl_(std::make_unique<Impl>()) {
  checkManifest(manifest);
  if (manifest.format_version != kDatasetFormat)
    throw Error(ErrorKind::kInput, "data set: format " + std::to_string(manifest.format_version) +
                                       " cannot be written; this program writes " + std::to_string(kDatasetFormat));
  impl_->directory = std::move(directory);
  impl_->manifest = std::move(manifest);
  try {
    prepareDirectory(impl_->directory);
    impl_->lock.emplace(impl_->directory);
    if (fs::exists(impl_->directory / kManifestName))
      impl_->resume();
    else
      impl_->writeManifestFile();
    removeTemporaryFiles(impl_->directory);
    impl_->verify(options);
    if (impl_->manifest.compression > 0)
      impl_->compressor.emplace(impl_->manifest.compression, std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  } catch (const fs::filesystem_error& error) {
    throw Error(ErrorKind::kIo, impl_->directory.string() + ": " + error.code().message());
  } catch (const std::system_error& error) {
    throw Error(ErrorKind::kIo, impl_->directory.string() + ": cannot create compression threads: " + error.code().message());
  }
}

DatasetWriter::~DatasetWriter() = default;

bool DatasetWriter::isVerified() const {
  return impl_->is_verified;
}

bool DatasetWriter::isComplete(std::uint64_t shard) const {
  return shard < impl_->shard_ends.size() && !impl_->shard_ends[shard].empty();
}

void DatasetWriter::writeShard(std::uint64_t shard, const ShardData& data) {
  if (shard >= impl_->shard_ends.size())
    throw Error(ErrorKind::kInput,
                "data set: there is no shard " + std::to_string(shard) + ": it has " + std::to_string(impl_->shard_ends.size()));
  assert(isVerified());
  if (isComplete(shard)) throw Error(ErrorKind::kInput, impl_->shardFile(shard).string() + ": is complete already");
  Compressor* const compressor = impl_->compressor ? &*impl_->compressor : nullptr;
  writeWithChecksum(impl_->shardFile(shard), shardImage(impl_->manifest, shard, data, compressor));
  std::uint64_t end = 0;
  for (const std::uint64_t length : data.episode_lengths) impl_->shard_ends[shard].push_back(end += length);
}

void DatasetWriter::finish() {
  assert(isVerified());
  const std::vector<bool> on_disk = shardsOnDisk(impl_->directory, impl_->manifest);
  for (std::uint64_t shard = 0; shard < impl_->shard_ends.size(); ++shard)
    if (!isComplete(shard) || !on_disk[shard])
      throw Error(ErrorKind::kIo, impl_->shardFile(shard).string() + ": is missing; the data set is incomplete");
  writeWithChecksum(impl_->directory / kViewName, viewImage(impl_->manifest, impl_->shard_ends));
}

}  // namespace taxelsim
