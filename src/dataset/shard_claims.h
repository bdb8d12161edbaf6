// Claims of shards by writers that share a directory: one byte of the file .claims per shard, under a lock of the open file description
// (F_OFD_SETLK). The kernel, or the server of a network file system, releases the claims of a process that ends for any reason.
//
// Claims only avoid double work. Where a file system keeps locks on one machine, two machines may write the same shard. Both write the same
// bytes, each under a temporary name of its own, and rename them atomically.
#pragma once

#include <cstdint>
#include <filesystem>

namespace taxelsim::dataset {

inline constexpr const char* kClaimsName = ".claims";

// Thread-safe.
class ShardClaims {
 public:
  // Throws Error(kIo) if the file system refuses.
  explicit ShardClaims(const std::filesystem::path& directory);
  ~ShardClaims();
  ShardClaims(const ShardClaims&) = delete;
  ShardClaims& operator=(const ShardClaims&) = delete;

  // True if this object holds the claim now; false if another one does. Throws Error(kIo) if the file system has no locks.
  bool claim(std::uint64_t shard);
  void release(std::uint64_t shard);

  // Waits for the claim on the manifest; only one writer at a time may create or change it. Throws Error(kIo) after 60 s.
  void claimManifest();
  void releaseManifest();

 private:
  bool lock(short type, std::uint64_t byte);

  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace taxelsim::dataset
