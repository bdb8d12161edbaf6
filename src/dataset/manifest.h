// The manifest of a data set, dataset.yaml: everything that determines its content. docs/reference/scene_file.md has the format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "taxelsim/dataset.h"

namespace taxelsim::dataset {

inline constexpr const char* kManifestName = "dataset.yaml";
inline constexpr const char* kViewName = "dataset.h5";

inline constexpr std::uintmax_t kMaxManifestBytes = std::uintmax_t{24} << 20;
inline constexpr std::uint64_t kMaxShards = 1'000'000;
inline constexpr std::uint64_t kMaxEpisodesPerShard = 1'000'000;  // as in scenes
inline constexpr std::size_t kMaxListedEpisodes = 1'000'000;      // of a data set of chosen episodes
inline constexpr std::size_t kMaxColumns = 4096;

// "shard-000012.h5"
std::string shardName(std::uint64_t shard);

// First episode and number of episodes of a shard.
std::uint64_t firstEpisode(const Manifest& manifest, std::uint64_t shard);
std::uint64_t numEpisodes(const Manifest& manifest, std::uint64_t shard);

// SHA-256 of the resolved scene, hexadecimal.
std::string sceneHash(const Manifest& manifest);

// Throws Error(kInput) for values out of range and invalid columns.
void checkManifest(const Manifest& manifest);

// YAML text. Deterministic.
std::string writeManifest(const Manifest& manifest);

// Throws Error(kInput), with file and line, for text that is not a valid manifest of format 1 or 2.
Manifest parseManifest(const std::filesystem::path& file, const std::string& text);

// Checks that the data set in `directory` with manifest `found` can be resumed with manifest `requested`, that is, that both give the same
// bytes. The number of episodes may differ. Throws Error(kInput) with the first difference.
void checkSame(const std::filesystem::path& directory, const Manifest& found, const Manifest& requested);

}  // namespace taxelsim::dataset
