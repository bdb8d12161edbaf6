// What must hold in a glTF file before the importer sees it, and how many triangles it should find there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace taxelsim {

// What is wrong with the file, as the end of a sentence; empty when nothing is.
std::string gltfFault(const std::filesystem::path& file, bool is_binary);

// Triangles of all meshes that the default scene uses, each mesh counted once, as its accessors claim. The importer leaves out triangles
// with indices out of range without a word; this is how that is noticed. Nothing where the file has other primitives than triangle lists.
std::optional<std::uint64_t> gltfTriangles(const std::filesystem::path& file, bool is_binary);

}  // namespace taxelsim
