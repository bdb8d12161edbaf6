// Keeps simplified meshes in files, because the simplification of a large mesh takes minutes.
//
//   name:    CACHE/taxelsim/meshes/SHA-256 of (kSimplificationVersion, max_error, vertices, triangles)
//   content: SHA-256 of the rest, number of vertices, number of triangles, vertices (float32), triangles (uint32)
//
// No vertices and no triangles stand for a mesh that the simplification left as it is. A file that is damaged counts as missing.
#pragma once

#include <cstddef>
#include <cstdint>

#include "taxelsim/object.h"

namespace taxelsim {

// Meshes with fewer triangles are simplified each time: 0.2 s at most.
inline constexpr std::size_t kMinCachedTriangles = 20'000;

// Bytes of all stored meshes together. The oldest are removed first.
inline constexpr std::uintmax_t kMaxSimplificationCacheBytes = std::uintmax_t{1} << 30;

// Returns what simplifyMesh(mesh, max_error) returns. Reads it from the user's cache directory or writes it there, if there is such a
// directory. A cache that cannot be read or written is logged and not an error.
Mesh simplifyMeshOnce(const Mesh& mesh, double max_error);

}  // namespace taxelsim
