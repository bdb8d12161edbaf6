// Files that scene and sensor files refer to. Their bytes are part of the resolved scene, their location is not.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "scene/yaml_reader.h"

namespace taxelsim {

// The file that `key` of `map` names, relative to `directory`; `what`: the file in words, by default as the block of `map` has it. Writes
// its name without a path and the SHA-256 of its bytes to the canonical text, and compares it with the key `sha256`, if given. Stores the
// SHA-256 in *sha256 unless that is null. Throws Error(kInput) at the key when there is no regular file or it has more than `max_bytes`.
std::filesystem::path readHashedFile(const YamlMap& map, std::string_view key, const std::filesystem::path& directory,
                                     std::uintmax_t max_bytes, std::string* sha256 = nullptr, const std::string& what = "");

}  // namespace taxelsim
