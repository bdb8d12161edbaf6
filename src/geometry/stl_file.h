// STL files, binary and text. Normals and attributes are skipped.
#pragma once

#include <filesystem>
#include <string>

#include "taxelsim/object.h"

namespace taxelsim {

// Reads a regular file into an empty mesh, in coordinates of the file, three vertices per triangle. Returns the first problem as a sentence
// about the file, empty if there is none. Coordinates may be infinite or NaN. A binary file has exactly the size that its number of
// triangles implies. Any other file is text that starts with "solid" and ends with "endsolid".
std::string readStl(const std::filesystem::path& file, Mesh& mesh);

}  // namespace taxelsim
