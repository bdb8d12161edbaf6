// Validation of untrusted mesh files before Assimp reads them. Rejects files that would make Assimp allocate or recurse without bound
// (counts larger than the file can hold, deep nesting) or that it would silently misread (malformed numbers). A file that passes may
// still be invalid. STL and PLY always pass: Assimp does not read them (stl_file.h, ply_file.h).
#pragma once

#include <filesystem>
#include <string>

namespace taxelsim {

enum class MeshFormat { kObj, kStl, kPly, kGltf, kGlb };

// Describes the first problem found, as a sentence about the file ("it ends before endsolid"); empty if none. `file` must be an existing
// regular file of at most kMaxMeshFileBytes.
std::string validateMeshFile(const std::filesystem::path& file, MeshFormat format);

}  // namespace taxelsim
