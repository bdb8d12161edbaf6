// The description of a column: checks, and its entry in dataset.yaml.
#pragma once

#include <cstddef>
#include <string>

#include "base/yaml_parse.h"
#include "taxelsim/dataset.h"

namespace taxelsim::dataset {

inline constexpr const char* kEpisodeEnds = "meta/episode_ends";
// Most bytes of a text in an attribute. HDF5 stores attributes of at most 64 KiB in the header of an object.
inline constexpr std::size_t kMaxAttributeBytes = std::size_t{16} << 10;

// The column of every shard that no manifest lists.
Column episodeEndsColumn();

// Bytes of one row.
std::size_t rowBytes(const Column& column);

// Throws Error(kInput) for an invalid name, shape, type or text.
void checkColumn(const Column& column);

// Everything about a column except its name, for comparison and messages.
std::string detailOf(const Column& column);

// The entry in dataset.yaml.
std::string writeColumn(const Column& column);
Column parseColumn(const std::string& file, const YamlTree& node);

}  // namespace taxelsim::dataset
