#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <optional>
#include <span>
#include <system_error>
#include <thread>

#include "base/files.h"
#include "base/log.h"
#include "dataset/checksum.h"
#include "dataset/checksum_list.h"
#include "dataset/compressor.h"
#include "dataset/directory_lock.h"
#include "dataset/manifest.h"
#include "dataset/shard.h"
#include "dataset/shard_claims.h"
#include "dataset/shard_listing.h"
#include "dataset/verification.h"
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
    if (name == kLockName || name == kClaimsName || isTemporaryName(name)) continue;
    if (fs::exists(directory / kManifestName)) return;  // another process has written it since
    throw Error(ErrorKind::kInput,
                directory.string() + ": is not empty and has no data set (it contains " + name + "): choose another directory");
  }
}

// Also those of writers that shared the directory.
void removeTemporaryFiles(const fs::path& directory) {
  std::vector<fs::path> leftovers;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
    const std::string name = entry.path().filename().string();
    if (name == kClaimsName || isTemporaryName(name)) leftovers.push_back(entry.path());
  }
  for (const fs::path& file : leftovers) removeFile(file);
}

}  // namespace

ShardRange partOfShards(std::uint64_t num_shards, std::uint64_t part, std::uint64_t num_parts) {
  // The first num_shards % num_parts parts have one shard more.
  const auto start = [&](std::uint64_t index) { return num_shards / num_parts * index + std::min(index, num_shards % num_parts); };
  return {start(part - 1), start(part)};
}

struct DatasetWriter::Impl {
  fs::path directory;
  Manifest manifest;
  ShardRange range;
  FileStamp opened;  // of the directory
  std::optional<DirectoryLock> lock;
  std::optional<ShardClaims> claims;                   // of a shared directory
  std::optional<Compressor> compressor;                // if the data set is compressed
  std::vector<std::vector<std::uint64_t>> shard_ends;  // (num_shards), empty if the shard is missing
  std::vector<HashedShard> hashes;                     // (num_shards), without digest if the shard is missing
  bool is_verified = false;
  std::atomic<bool> is_list_complete = true;  // dataset.checksums vouches for all shards on disk that this writer knows

  fs::path shardFile(std::uint64_t shard) const { return directory / shardName(shard); }

  void open(const DatasetWriterOptions& options) {
    range = options.shards.value_or(ShardRange{.first = 0, .end = manifest.numShards()});
    if (range.first > range.end || range.end > manifest.numShards())
      throw Error(ErrorKind::kInput, "shards: " + std::to_string(range.first) + " to " + std::to_string(range.end - 1) +
                                         " requested, the data set has 0 to " + std::to_string(manifest.numShards() - 1));
    prepareDirectory(directory);
    opened = stampOf(directory);
    lock.emplace(directory, options.shards ? LockMode::kShared : LockMode::kExclusive);
    if (options.shards) claims.emplace(directory).claimManifest();
    if (fs::exists(directory / kManifestName))
      resume();
    else
      writeManifestFile();
    if (claims)
      claims->releaseManifest();
    else
      removeTemporaryFiles(directory);
    verify(options);
  }

  // A file system that was unmounted leaves an empty directory of the same name, in which shards would be lost.
  void requireSameDirectory() const {
    struct stat found {};
    if (::stat(directory.c_str(), &found) == 0 && found.st_dev == opened.device && found.st_ino == opened.inode) return;
    throw Error(ErrorKind::kIo, directory.string() + ": is not the directory that was opened any more: it was moved, removed or unmounted");
  }

  void writeManifestFile() {
    const std::string text = writeManifest(manifest);
    if (text.size() > kMaxManifestBytes)
      throw Error(ErrorKind::kInput, "data set: its manifest would have " + std::to_string(text.size()) +
                                         " bytes, which is not allowed: at most " + std::to_string(kMaxManifestBytes));
    writeFileAtomically(directory / kManifestName, std::as_bytes(std::span(text)));
  }

  // Continues an existing data set, possibly with more episodes. The last shard of a shorter data set may be partly filled; it would have
  // to grow, so it must not exist yet.
  void resume() {
    const fs::path file = directory / kManifestName;
    const Manifest found = parseManifest(file, readTextFile(file, kMaxManifestBytes));
    checkSame(directory, found, manifest);
    manifest.probe_sha256 = found.probe_sha256;
    if (found.num_episodes == manifest.num_episodes) return;
    if (claims)
      throw Error(ErrorKind::kInput, directory.string() + ": holds a data set of " + std::to_string(found.num_episodes) + " episodes, " +
                                         std::to_string(manifest.num_episodes) + " requested: processes that share it cannot extend it");
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

  // Compares the shards on disk with their checksums and the manifest.
  void verify(const DatasetWriterOptions& options) {
    shard_ends.resize(manifest.numShards());
    hashes.resize(manifest.numShards());
    const std::vector<bool> on_disk = shardsOnDisk(directory, manifest);
    std::vector<std::uint64_t> shards;
    for (std::uint64_t shard = range.first; shard < range.end; ++shard)
      if (on_disk[shard]) shards.push_back(shard);
    const auto on_verify = [&](std::uint64_t num_verified) {
      if (options.on_verify) options.on_verify(num_verified, shards.size());
    };
    const ChecksumList list(directory, manifest.numShards());
    is_verified = verifyShards(directory, list, shards, {.verify_all = options.verify_all, .stop = options.stop, .on_verify = on_verify},
                               [&](const VerifiedShard& result) { use(result, options.repair); });
    if (is_verified) writeList();
  }

  void use(const VerifiedShard& result, bool repair) {
    const fs::path file = shardFile(result.shard);
    try {
      if (result.problem) std::rethrow_exception(result.problem);
      shard_ends[result.shard] =
          checkShardContents(std::array{ShardFile{file, result.shard}}, manifest, /*contents=*/true, Isolation::kNone).front();
      hashes[result.shard] = result.hashed;
      is_list_complete = is_list_complete && result.is_vouched_for;
    } catch (const Error& problem) {
      if (!repair || problem.kind() != ErrorKind::kInput) throw;
      if (claims && !claims->claim(result.shard)) return;  // another process makes it again
      logWarning(problem.what() + std::string("; the shard is removed and made again"));
      removeWithChecksum(directory / kViewName);  // it would show zeros in place of the shard
      removeWithChecksum(file);
    }
  }

  // Vouches for what is on disk, so that the next run does not read it again. Writers that share a directory know a part of it only.
  void writeList() {
    if (claims || is_list_complete) return;
    requireSameDirectory();
    writeChecksumList(directory, hashes);
    is_list_complete = true;
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
    impl_->open(options);
    if (impl_->manifest.compression > 0)
      impl_->compressor.emplace(impl_->manifest.compression, std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  } catch (const fs::filesystem_error& error) {
    throw Error(ErrorKind::kIo, impl_->directory.string() + ": " + error.code().message());
  } catch (const std::system_error& error) {
    throw Error(ErrorKind::kIo, impl_->directory.string() + ": cannot create compression threads: " + error.code().message());
  }
}

DatasetWriter::~DatasetWriter() {
  try {
    if (impl_->is_verified) impl_->writeList();
  } catch (const std::exception& error) {
    logWarning(error.what());  // the next run reads the shards
  }
}

bool DatasetWriter::isVerified() const {
  return impl_->is_verified;
}

bool DatasetWriter::isComplete(std::uint64_t shard) const {
  return shard < impl_->shard_ends.size() && !impl_->shard_ends[shard].empty();
}

bool DatasetWriter::isOnDisk(std::uint64_t shard) const {
  std::error_code error;
  return fs::exists(impl_->shardFile(shard), error);
}

bool DatasetWriter::claim(std::uint64_t shard) {
  if (isOnDisk(shard)) return false;
  if (!impl_->claims) return true;
  if (!impl_->claims->claim(shard)) return false;
  // Its last holder may have written it and released it in between.
  if (!isOnDisk(shard)) return true;
  impl_->claims->release(shard);
  return false;
}

void DatasetWriter::writeShard(std::uint64_t shard, const ShardData& data) {
  if (shard >= impl_->shard_ends.size())
    throw Error(ErrorKind::kInput,
                "data set: there is no shard " + std::to_string(shard) + ": it has " + std::to_string(impl_->shard_ends.size()));
  assert(isVerified());
  if (isComplete(shard)) throw Error(ErrorKind::kInput, impl_->shardFile(shard).string() + ": is complete already");
  impl_->requireSameDirectory();
  Compressor* const compressor = impl_->compressor ? &*impl_->compressor : nullptr;
  const fs::path file = impl_->shardFile(shard);
  impl_->hashes[shard].digest = writeWithChecksum(file, shardImage(impl_->manifest, shard, data, compressor));
  impl_->hashes[shard].stamp = stampOf(file);
  impl_->is_list_complete = false;
  if (impl_->claims) impl_->claims->release(shard);
  std::uint64_t end = 0;
  for (const std::uint64_t length : data.episode_lengths) impl_->shard_ends[shard].push_back(end += length);
}

void DatasetWriter::finish() {
  assert(isVerified() && !impl_->claims);
  impl_->requireSameDirectory();
  const std::vector<bool> on_disk = shardsOnDisk(impl_->directory, impl_->manifest);
  for (std::uint64_t shard = 0; shard < impl_->shard_ends.size(); ++shard)
    if (!isComplete(shard) || !on_disk[shard])
      throw Error(ErrorKind::kIo, impl_->shardFile(shard).string() + ": is missing; the data set is incomplete");
  writeWithChecksum(impl_->directory / kViewName, viewImage(impl_->manifest, impl_->shard_ends));
  impl_->writeList();
}

}  // namespace taxelsim
