// Check of the lengths of arrays that a caller hands over.
#pragma once

#include <cstddef>
#include <string>

#include "taxelsim/error.h"

namespace taxelsim {

// Throws Error(kInput) that names the array unless found == expected.
inline void checkLength(const char* name, std::size_t found, std::size_t expected) {
  if (found == expected) return;
  throw Error(ErrorKind::kInput, std::string(name) + ": " + std::to_string(found) + " values are not allowed: " + std::to_string(expected));
}

}  // namespace taxelsim
