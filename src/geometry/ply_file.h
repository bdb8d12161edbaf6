// PLY files: text and binary, their vertices and their faces or triangle strips. All other elements and properties are skipped.
#pragma once

#include <string>
#include <string_view>

#include "taxelsim/object.h"

namespace taxelsim {

// Reads the bytes of a file into an empty mesh, in coordinates of the file. Returns the first problem as a sentence about the file ("it
// ends before ..."), empty if there is none. Coordinates may be infinite or NaN. Allocates in proportion to the bytes.
std::string readPly(std::string_view bytes, Mesh& mesh);

}  // namespace taxelsim
