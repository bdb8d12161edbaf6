// Hashes shards in parallel.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "dataset/checksum_list.h"

namespace taxelsim::dataset {

// Result for one shard on disk.
struct VerifiedShard {
  std::uint64_t shard = 0;
  HashedShard hashed;           // without a digest if there is a problem
  bool is_vouched_for = false;  // by the list; the shard was not read
  std::exception_ptr problem;   // an Error
};

struct VerificationOptions {
  bool verify_all = false;                  // hash the shards that the list vouches for, too
  const std::atomic<bool>* stop = nullptr;  // may be null
  // Called with the number of shards that are done, before each shard and at the end. May be empty.
  std::function<void(std::uint64_t)> on_verify{};
};

// Compares the shards, all on disk, with their checksum files, and calls `use` with each in order. Both callbacks run in the caller's
// thread; what they throw ends the verification. Returns false if it was stopped.
bool verifyShards(const std::filesystem::path& directory, const ChecksumList& list, std::span<const std::uint64_t> shards,
                  const VerificationOptions& options, const std::function<void(const VerifiedShard&)>& use);

}  // namespace taxelsim::dataset
