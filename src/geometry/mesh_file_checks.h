// Looks at a mesh file before the importer does, and refuses what would make it allocate or recurse without bound: counts that the file is
// too short to hold, deep nesting; and what the importer would read wrong without a word. Not a parser: what passes may still be no mesh.
#pragma once

#include <filesystem>
#include <string>

namespace taxelsim {

enum class MeshFormat { kObj, kStl, kPly, kGltf, kGlb };

// What is wrong with the file, as the end of a sentence; empty when nothing is. The file must exist, be regular and of bounded size.
std::string findFault(const std::filesystem::path& file, MeshFormat format);

}  // namespace taxelsim
