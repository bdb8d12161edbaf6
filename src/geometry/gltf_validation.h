// Checks on the JSON of glTF files that run before Assimp reads them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace taxelsim {

// Describes the first problem found, as the predicate of a sentence about the file ("its JSON nests deeper than 64 levels"); empty if none.
// Checks nesting depth, the node tree, and the range of counts and byte sizes.
std::string validateGltf(const std::filesystem::path& file, bool is_binary);

// Number of triangles in all meshes that the default scene uses, each mesh counted once, according to the accessors. Assimp silently drops
// triangles with indices out of range; comparing its count with this one detects that. Returns nothing if the file has primitives other
// than triangle lists, or invalid references.
std::optional<std::uint64_t> countGltfTriangles(const std::filesystem::path& file, bool is_binary);

}  // namespace taxelsim
