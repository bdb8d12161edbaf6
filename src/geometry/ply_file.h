// PLY files: text and binary, their vertices and their faces or triangle strips. All other elements and properties are skipped.
//
// Assimp 5.2 does not read them here: it takes a first byte of a binary body that is a blank for text, which shifts all numbers, and
// damaged headers make it write past its buffers.
#pragma once

#include <string>
#include <string_view>

#include "taxelsim/object.h"

namespace taxelsim {

// Reads the bytes of a file into an empty mesh, in coordinates of the file. Returns the first problem as a sentence about the file ("it
// ends before ..."), empty if there is none. Coordinates may be infinite or NaN. Allocates in proportion to the bytes.
std::string readPly(std::string_view bytes, Mesh& mesh);

}  // namespace taxelsim
