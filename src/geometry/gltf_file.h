// glTF 2.0 files, binary (.glb) and text (.gltf): the triangles of the default scene, as lists, strips and fans, placed by its nodes.
// Materials, normals, texture coordinates, skins and animations are skipped; points and lines as well. Whatever else decides where a vertex
// is and is not read here is refused: sparse accessors, morph targets, unknown required extensions.
//
// Vertices have the bits that Assimp 5.2 gave them, which read glTF in versions before.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "taxelsim/object.h"

namespace taxelsim {

// The vertex of a mesh at a point in coordinates of the file; `vertex`: its index.
using PlaceVertex = std::function<std::array<float, 3>(const std::array<double, 3>& point, std::size_t vertex)>;

// Reads a regular file into an empty mesh. Returns the first problem as a sentence about the file ("accessors[3].count is missing: ..."),
// empty if there is none. A .gltf may name other regular files of its folder for its buffers. Allocates in proportion to the bytes of all
// files, and for at most 2^24 vertices and as many triangles. Passes on what `place` throws.
std::string readGltf(const std::filesystem::path& file, bool is_binary, const PlaceVertex& place, Mesh& mesh);

}  // namespace taxelsim
