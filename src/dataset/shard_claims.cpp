#include "dataset/shard_claims.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <thread>

#include "dataset/manifest.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {

constexpr std::uint64_t kManifestByte = kMaxShards;         // after the bytes of all shards
constexpr std::chrono::seconds kMaxWait{60};                // writing a manifest takes milliseconds
constexpr std::chrono::milliseconds kWaitBetweenTries{20};  // of a lock that another process holds

}  // namespace

ShardClaims::ShardClaims(const std::filesystem::path& directory) : file_(directory / kClaimsName) {
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw Error(ErrorKind::kIo, "cannot create " + file_.string() + ": " + std::strerror(errno));
}

ShardClaims::~ShardClaims() {
  ::close(descriptor_);
}

bool ShardClaims::lock(short type, std::uint64_t byte) {
  struct flock range {};
  range.l_type = type;
  range.l_whence = SEEK_SET;
  range.l_start = static_cast<off_t>(byte);
  range.l_len = 1;
  while (::fcntl(descriptor_, F_OFD_SETLK, &range) != 0) {
    if (errno == EAGAIN || errno == EACCES) return false;
    if (errno != EINTR)
      throw Error(ErrorKind::kIo, "cannot lock a byte of " + file_.string() + ": " + std::strerror(errno) +
                                      "; writers by ranges of shards need a file system with POSIX locks");
  }
  return true;
}

bool ShardClaims::claim(std::uint64_t shard) {
  return lock(F_WRLCK, shard);
}

void ShardClaims::release(std::uint64_t shard) {
  lock(F_UNLCK, shard);
}

void ShardClaims::claimManifest() {
  const auto deadline = std::chrono::steady_clock::now() + kMaxWait;
  while (!lock(F_WRLCK, kManifestByte)) {
    if (std::chrono::steady_clock::now() > deadline)
      throw Error(ErrorKind::kIo, file_.string() + ": another process has held the lock of the manifest for more than " +
                                      std::to_string(kMaxWait.count()) + " s");
    std::this_thread::sleep_for(kWaitBetweenTries);
  }
}

void ShardClaims::releaseManifest() {
  lock(F_UNLCK, kManifestByte);
}

}  // namespace taxelsim::dataset
