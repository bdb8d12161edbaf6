// dataset.yaml: what decides a data set's content. Not the shards themselves.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "taxelsim/dataset.h"

namespace taxelsim::dataset {

inline constexpr std::uint64_t kFormatVersion = 1;
inline constexpr const char* kManifestName = "dataset.yaml";
inline constexpr const char* kViewName = "dataset.h5";
inline constexpr const char* kEpisodeEnds = "meta/episode_ends";

// "shard-000012.h5"
std::string shardName(std::uint64_t shard);

// Bytes of one row.
std::size_t rowBytes(const Column& column);

std::uint64_t firstEpisode(const Manifest& manifest, std::uint64_t shard);
std::uint64_t numEpisodes(const Manifest& manifest, std::uint64_t shard);

// SHA-256 of the resolved scene, hexadecimal.
std::string sceneHash(const Manifest& manifest);

// Throws Error(kInput) for a manifest that no data set can have.
void checkManifest(const Manifest& manifest);

// YAML text; the same manifest gives the same bytes.
std::string writeManifest(const Manifest& manifest);

// Throws Error(kInput), with file and line, for anything but a manifest of this format.
Manifest parseManifest(const std::filesystem::path& file, const std::string& text);

// Throws Error(kInput), naming the first difference, when `wanted` would give other bytes than the data set in `directory` that `found`
// describes. The number of episodes may differ.
void checkSame(const std::filesystem::path& directory, const Manifest& found, const Manifest& wanted);

}  // namespace taxelsim::dataset
