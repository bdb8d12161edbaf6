#include "cli/shard_options.h"

#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <utility>

#include "taxelsim/error.h"

namespace taxelsim::cli {

std::string checkRange(const std::string& text) {
  const auto range = numberPair(text, "..");
  return range && range->first <= range->second ? "" : text + " is not FIRST..LAST, such as 40..79, both included";
}

std::string checkPart(const std::string& text) {
  const auto part = numberPair(text, "/");
  return part && part->first >= 1 && part->first <= part->second ? "" : text + " is not K/N, such as 3/16, K from 1 to N";
}

std::optional<std::pair<std::uint64_t, std::uint64_t>> numberPair(const std::string& text, const std::string& separator) {
  const char* const end = text.data() + text.size();
  std::pair<std::uint64_t, std::uint64_t> numbers;
  const std::from_chars_result first = std::from_chars(text.data(), end, numbers.first);
  if (first.ec != std::errc() || !std::string_view(first.ptr, end).starts_with(separator)) return {};
  const std::from_chars_result second = std::from_chars(first.ptr + separator.size(), end, numbers.second);
  if (second.ec != std::errc() || second.ptr != end) return {};
  return numbers;
}

void addShardOptions(CLI::App& command, ShardOptions& options) {
  CLI::Option* const shards =
      command
          .add_option("--shards", options.shards,
                      "Make these shards only, both ends included; several processes may work in DIR. `taxelsim finish` completes it")
          ->check(checkRange)
          ->type_name("A..B");
  command.add_option("--part", options.part, "Make part K of N of the shards, K from 1; as --shards")
      ->check(checkPart)
      ->type_name("K/N")
      ->excludes(shards);
}

std::optional<ShardRange> chosenShards(const ShardOptions& options, std::uint64_t num_shards) {
  if (!options.part.empty()) {
    const auto [part, num_parts] = *numberPair(options.part, "/");
    return partOfShards(num_shards, part, num_parts);
  }
  if (options.shards.empty()) return {};
  const auto [first, last] = *numberPair(options.shards, "..");
  if (last >= num_shards)
    throw Error(ErrorKind::kInput,
                fmt::format("--shards: {} is not allowed: the data set has shards 0 to {}", options.shards, num_shards - 1));
  return ShardRange{.first = first, .end = last + 1};
}

}  // namespace taxelsim::cli
