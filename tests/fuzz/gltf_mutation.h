// Random changes of binary glTF that a parser of containers or of JSON does not stop: the chunks and their lengths stay valid, and values
// of the JSON become other values that glTF has.
#pragma once

#include <random>
#include <string>
#include <string_view>

namespace taxelsim::fuzz {

// Changes one to four values of the JSON, or bytes of the binary chunk. Starts from a triangle if `bytes` are not a .glb.
std::string mutatedGlb(std::string_view bytes, std::mt19937& random);

}  // namespace taxelsim::fuzz
