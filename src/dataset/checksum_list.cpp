#include "dataset/checksum_list.h"

#include <charconv>
#include <fstream>
#include <system_error>

#include "base/files.h"
#include "base/log.h"
#include "dataset/checksum.h"
#include "dataset/manifest.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {

namespace fs = std::filesystem;

ChecksumList::ChecksumList(const fs::path& directory, std::uint64_t num_shards) {
  const fs::path file = directory / kChecksumListName;
  std::error_code error;
  if (!fs::exists(file, error)) return;
  if (fs::is_regular_file(file, error) && parse(file, num_shards)) {
    written_ = stampOf(file).changed;
  } else {
    logWarning(file.string() + ": is damaged; all shards are compared with their own checksum files");
    lines_.clear();
  }
}

// Lines are in ascending order of shards. Their names are those of shards of this directory and of no other file.
bool ChecksumList::parse(const fs::path& file, std::uint64_t num_shards) {
  lines_.resize(num_shards);
  std::ifstream stream(file, std::ios::binary);
  std::uint64_t next = 0;
  for (std::string text; std::getline(stream, text);) {
    Line line{.digest = text.substr(0, kDigestDigits), .size = 0};
    const std::size_t size_at = kDigestDigits + 1;
    if (!isDigest(line.digest) || text.size() <= size_at || text[kDigestDigits] != ' ') return false;
    const std::from_chars_result size = std::from_chars(text.data() + size_at, text.data() + text.size(), line.size);
    const std::string_view name(size.ptr, text.data() + text.size());
    while (next < num_shards && name != " " + shardName(next)) ++next;
    if (size.ec != std::errc() || next == num_shards) return false;
    lines_[next++] = std::move(line);
  }
  return stream.eof();
}

bool ChecksumList::vouchesFor(std::uint64_t shard, const fs::path& file) const {
  if (shard >= lines_.size() || lines_[shard].digest.empty()) return false;
  const Line& line = lines_[shard];
  const FileStamp stamp = stampOf(file);
  return fs::is_regular_file(file) && stamp.size == line.size && stamp.changed < written_ && readChecksum(file) == line.digest;
}

void writeChecksumList(const fs::path& directory, std::span<const HashedShard> shards) {
  std::string text;
  for (std::size_t shard = 0; shard < shards.size(); ++shard) {
    const HashedShard& hashed = shards[shard];
    if (!hashed.digest.empty()) text += hashed.digest + " " + std::to_string(hashed.stamp.size) + " " + shardName(shard) + "\n";
  }
  writeFileAtomically(directory / kChecksumListName, std::as_bytes(std::span(text)));
  // Later changes are later than the list.
  for (std::size_t shard = 0; shard < shards.size(); ++shard) {
    const fs::path file = directory / shardName(shard);
    if (shards[shard].digest.empty() || stampOf(file) == shards[shard].stamp) continue;
    removeFile(directory / kChecksumListName);
    throw Error(ErrorKind::kIo, file.string() + ": another program changed it while the data set was written");
  }
}

}  // namespace taxelsim::dataset
