// Completes a data set that several processes wrote.
#include <string>
#include <vector>

#include "dataset/checksum.h"
#include "dataset/directory_lock.h"
#include "dataset/manifest.h"
#include "dataset/shard_listing.h"
#include "dataset/view.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"
#include "taxelsim/version.h"

namespace taxelsim {

using namespace dataset;

namespace {

constexpr std::size_t kMaxNamed = 8;  // ranges of missing shards in a message

// "40..43, 57, ..."
std::string rangesText(const std::vector<std::uint64_t>& shards) {
  std::string text;
  std::size_t num_ranges = 0;
  for (std::size_t first = 0, last = 0; first < shards.size(); first = ++last) {
    while (last + 1 < shards.size() && shards[last + 1] == shards[last] + 1) ++last;
    if (++num_ranges > kMaxNamed) return text + ", ...";
    text += (first > 0 ? ", " : "") + std::to_string(shards[first]) + (last > first ? ".." + std::to_string(shards[last]) : "");
  }
  return text;
}

void requireAllShards(const std::filesystem::path& directory, const Manifest& manifest) {
  const std::vector<bool> on_disk = shardsOnDisk(directory, manifest);
  std::vector<std::uint64_t> missing;
  for (std::uint64_t shard = 0; shard < on_disk.size(); ++shard)
    if (!on_disk[shard]) missing.push_back(shard);
  if (missing.empty()) return;
  throw Error(ErrorKind::kInput, directory.string() + ": " + shardName(missing[0]) + " is missing; missing shards: " + rangesText(missing) +
                                     " (" + std::to_string(missing.size()) + " of " + std::to_string(on_disk.size()) +
                                     "); `taxelsim generate` with --shards makes them");
}

}  // namespace

bool finishDataset(const std::filesystem::path& directory, const FinishOptions& options) {
  const Manifest manifest = readManifest(directory);
  if (manifest.program_version != kVersion)
    throw Error(ErrorKind::kInput,
                directory.string() + ": taxelsim " + manifest.program_version + " wrote this data set, this is " + kVersion);
  { const DirectoryLock alone(directory); }  // missing shards may be on their way
  requireAllShards(directory, manifest);
  DatasetWriter writer(directory, manifest, {.verify_all = true, .on_verify = options.on_verify, .stop = options.stop});
  if (!writer.isVerified()) return false;
  writer.finish();
  return true;
}

void writeDatasetView(const std::filesystem::path& directory, std::uint64_t num_frames) {
  if (num_frames == 0) throw Error(ErrorKind::kInput, "frames of an episode: 0 is not allowed: at least 1");
  const Manifest manifest = readManifest(directory);
  std::vector<std::vector<std::uint64_t>> shard_ends(manifest.numShards());
  for (std::uint64_t shard = 0; shard < shard_ends.size(); ++shard)
    for (std::uint64_t episode = 1; episode <= numEpisodes(manifest, shard); ++episode) shard_ends[shard].push_back(episode * num_frames);
  writeWithChecksum(directory / kViewName, viewImage(manifest, shard_ends));
}

}  // namespace taxelsim
