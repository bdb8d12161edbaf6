// dataset.checksums: size and SHA-256 of the shards that were whole when it was written, one line each, "SHA-256 BYTES NAME".
//
// The list vouches for a shard while its size is the listed one, its checksum file has the listed digest, and neither its content nor its
// status has changed since the list was written. Both times are of the file system, so that clocks of machines do not matter. A shard that
// changed within the same tick of that clock as the list counts as changed. The list has no times in it: equal data sets have equal lists.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "dataset/file_stamp.h"

namespace taxelsim::dataset {

inline constexpr const char* kChecksumListName = "dataset.checksums";

// A shard whose bytes had that digest while the file had that stamp.
struct HashedShard {
  std::string digest;  // empty: not known
  FileStamp stamp;
};

// Thread-safe.
class ChecksumList {
 public:
  // Vouches for nothing.
  ChecksumList() = default;
  // Reads the list of a directory. Vouches for nothing if there is none. A damaged one is reported in the log and vouches for nothing.
  ChecksumList(const std::filesystem::path& directory, std::uint64_t num_shards);

  // Throws what stampOf() and readChecksum() throw.
  bool vouchesFor(std::uint64_t shard, const std::filesystem::path& file) const;

 private:
  struct Line {
    std::string digest;
    std::uint64_t size = 0;
  };

  bool parse(const std::filesystem::path& file, std::uint64_t num_shards);

  std::vector<Line> lines_;   // (num_shards) or empty; those that are not listed have an empty digest
  std::int64_t written_ = 0;  // ns, FileStamp::changed
};

// Writes the list of the shards (num_shards) that have a digest. Throws Error(kIo), and removes the list, if one of them is no longer as
// its stamp says.
void writeChecksumList(const std::filesystem::path& directory, std::span<const HashedShard> shards);

}  // namespace taxelsim::dataset
