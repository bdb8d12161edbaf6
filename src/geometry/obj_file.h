// Wavefront OBJ files: their vertices and faces. Lines, points, groups, materials, normals, texture coordinates and free-form surfaces are
// skipped.
//
// Vertices have the bits that Assimp 5.2 gave them, which read OBJ in versions before.
#pragma once

#include <string>
#include <string_view>

#include "taxelsim/object.h"

namespace taxelsim {

// Reads the text of a file into an empty mesh, in coordinates of the file. Returns the first problem as a sentence about the file ("line 3:
// vertex 2 lacks a coordinate"), empty if there is none. Allocates in proportion to the text.
std::string readObj(std::string_view text, Mesh& mesh);

}  // namespace taxelsim
