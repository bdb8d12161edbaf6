#include "dataset/shard_listing.h"

#include <charconv>
#include <string>
#include <string_view>
#include <system_error>

#include "dataset/manifest.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {

constexpr std::string_view kPrefix = "shard-";

}  // namespace

std::vector<bool> shardsOnDisk(const std::filesystem::path& directory, const Manifest& manifest) {
  std::vector<bool> found(manifest.numShards());
  std::error_code error;
  for (std::filesystem::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(kPrefix)) continue;
    std::uint64_t shard = 0;
    const std::from_chars_result number = std::from_chars(name.data() + kPrefix.size(), name.data() + name.size(), shard);
    if (number.ec == std::errc() && shard < found.size() && name == shardName(shard)) found[shard] = true;
  }
  if (error) throw Error(ErrorKind::kIo, "cannot list " + directory.string() + ": " + error.message());
  return found;
}

}  // namespace taxelsim::dataset
