// --shards and --part of `taxelsim generate`: the part of a data set that one of several processes makes.
#pragma once

#include <CLI/App.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "taxelsim/dataset.h"

namespace taxelsim::cli {

struct ShardOptions {
  std::string shards;  // "40..79", both ends included
  std::string part;    // "3/16", from 1
};

// Adds both options, which exclude each other; `options` must outlive the parsing.
void addShardOptions(CLI::App& command, ShardOptions& options);

// Numbers of "40..79", or of "3/16"; empty for a text that is not two numbers around the separator.
std::optional<std::pair<std::uint64_t, std::uint64_t>> numberPair(const std::string& text, const std::string& separator);

// Checks of options: the message about a text that is not "40..79" or "3/16"; empty for one that is.
std::string checkRange(const std::string& text);
std::string checkPart(const std::string& text);

// The shards that the options choose among `num_shards`; empty without options. Throws Error(kInput) for shards that the data set does not
// have.
std::optional<ShardRange> chosenShards(const ShardOptions& options, std::uint64_t num_shards);

}  // namespace taxelsim::cli
