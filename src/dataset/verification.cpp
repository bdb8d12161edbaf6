#include "dataset/verification.h"

#include <algorithm>
#include <thread>

#include "base/sha256.h"
#include "dataset/checksum.h"
#include "dataset/manifest.h"
#include "dataset/thread_pool.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {

// Shards per thread between two reports. A network file system answers several at once.
constexpr std::size_t kShardsPerThread = 4;

VerifiedShard verified(const std::filesystem::path& directory, const ChecksumList& list, std::uint64_t shard,
                       const VerificationOptions& options) {
  VerifiedShard result{.shard = shard, .hashed = {}, .is_vouched_for = false, .problem = nullptr};
  const std::filesystem::path file = directory / shardName(shard);
  if (options.stop != nullptr && *options.stop) throw Stopped();
  try {
    const FileStamp stamp = stampOf(file);
    result.is_vouched_for = !options.verify_all && list.vouchesFor(shard, file);
    result.hashed = {result.is_vouched_for ? readChecksum(file) : verifyChecksum(file, options.stop), stamp};
  } catch (const Error&) {
    result.problem = std::current_exception();
  }
  return result;
}

}  // namespace

bool verifyShards(const std::filesystem::path& directory, const ChecksumList& list, std::span<const std::uint64_t> shards,
                  const VerificationOptions& options, const std::function<void(const VerifiedShard&)>& use) {
  const auto report = [&](std::uint64_t num_verified) {
    if (options.on_verify) options.on_verify(num_verified);
  };
  if (!shards.empty()) {
    const std::size_t num_threads = std::min<std::size_t>(std::max(1u, std::thread::hardware_concurrency()), shards.size());
    ThreadPool threads(static_cast<int>(num_threads));
    std::vector<VerifiedShard> results(std::min(num_threads * kShardsPerThread, shards.size()));
    for (std::size_t first = 0; first < shards.size(); first += results.size()) {
      const std::size_t count = std::min(results.size(), shards.size() - first);
      report(first);
      try {
        threads.run(count, [&](int, std::size_t i) { results[i] = verified(directory, list, shards[first + i], options); });
      } catch (const Stopped&) {
        return false;
      }
      for (std::size_t i = 0; i < count; ++i) {
        if (i > 0) report(first + i);
        use(results[i]);
      }
    }
  }
  report(shards.size());
  return true;
}

}  // namespace taxelsim::dataset
